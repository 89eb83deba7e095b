#include "server/net/api/http_message.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"

namespace scancast {

std::string lowerCase(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return result;
}

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

std::string framingFault(const HttpRequest& request, unsigned version) {
    constexpr unsigned http11 = 11;
    if (request.count("transfer-encoding") == 0) return {};
    if (version < http11) return "Transfer-Encoding is not part of HTTP/1.0.";
    // Beast goes by the last coding of the last line, and by Content-Length where that is not chunked.
    if (lowerCase(request.header("transfer-encoding")) != "chunked")
        return "Transfer-Encoding: this server understands \"chunked\", once, and nothing else.";
    if (request.count("content-length") > 0)
        return "A request has a Content-Length or a Transfer-Encoding, not both.";
    return {};
}

std::string_view HttpResponse::body() const {
    if (bytes) return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    if (photo) return {reinterpret_cast<const char*>(photo->data()), photo->size()};
    return text;
}

HttpResponse& HttpResponse::set(std::string name, std::string value) {
    headers.emplace_back(std::move(name), std::move(value));
    return *this;
}

HttpResponse& HttpResponse::identify(const RequestIds& ids) {
    if (ids.request.empty()) return *this;
    if (problem) {
        problem->requestId = ids.request;
        text = printJson(toJson(*problem));
    }
    return set("X-Request-Id", ids.request);
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
    response.problem = problem;
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
