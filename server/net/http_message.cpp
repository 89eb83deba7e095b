#include "server/net/http_message.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"

namespace scancast {

std::string HttpRequest::header(std::string_view name) const {
    std::string joined;
    bool first = true;
    for (const auto& [key, value] : headers) {
        if (key != name) continue;
        if (!first) joined += ", ";
        first = false;
        joined += value;
    }
    return joined;
}

std::size_t HttpRequest::count(std::string_view name) const {
    return std::size_t(
        std::count_if(headers.begin(), headers.end(), [&](const auto& h) { return h.first == name; }));
}

std::string_view HttpResponse::body() const {
    if (bytes) return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    return text;
}

HttpResponse& HttpResponse::set(std::string name, std::string value) {
    headers.emplace_back(std::move(name), std::move(value));
    return *this;
}

const std::string* HttpResponse::find(std::string_view name) const {
    for (const auto& [key, value] : headers) {
        if (key == name) return &value;
    }
    return nullptr;
}

HttpResponse problemResponse(const Problem& problem) {
    HttpResponse response;
    response.status = problem.status;
    response.text = printJson(toJson(problem));
    response.set("Content-Type", std::string(problemMediaType)).set("Cache-Control", "no-store");
    if (problem.status == 503 || problem.status == 429) response.set("Retry-After", "1");
    return response;
}

HttpResponse jsonResponse(const nlohmann::json& body) {
    HttpResponse response;
    response.text = printJson(body);
    response.set("Content-Type", "application/json").set("Cache-Control", "no-cache");
    return response;
}

HttpResponse textResponse(int status, std::string text) {
    HttpResponse response;
    response.status = status;
    response.text = std::move(text);
    response.set("Content-Type", "text/plain; charset=utf-8").set("Cache-Control", "no-store");
    return response;
}

}  // namespace scancast
