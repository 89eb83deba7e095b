#include "server/net/log/request_record.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/text/plain_text.hpp"

namespace scancast {
namespace {

double millisecondsSince(RequestRecord::Clock::time_point begun, RequestRecord::Clock::time_point now) {
    return std::chrono::duration<double, std::milli>(now - begun).count();
}

std::string_view name(RequestRecord::Event event) {
    switch (event) {
        case RequestRecord::Event::Request:
            return "request";
        case RequestRecord::Event::StreamOpened:
            return "stream opened";
        case RequestRecord::Event::StreamEnded:
            return "stream ended";
    }
    return "request";
}

double rounded(double value) {
    constexpr double thousand = 1000;
    return std::round(value * thousand) / thousand;
}

}  // namespace

std::string RequestRecord::sentence(Clock::time_point now) const {
    const std::string asked = method.empty() ? "a connection" : method + " " + target;
    std::string text;
    if (event == Event::StreamOpened) {
        text = fmt::format("{} {}, stream {} opened", asked, status, session);
    } else if (event == Event::StreamEnded) {
        text = fmt::format("{} {}, stream {} ended: {} frames, {} bytes in {:.1f} s", asked, status, session,
                           frames, bytes, millisecondsSince(begun, now) / 1000);
    } else {
        text =
            fmt::format("{} {}, {} bytes in {:.1f} ms", asked, status, bytes, millisecondsSince(begun, now));
    }
    if (!note.empty()) text += " (" + note + ")";
    if (price) text += fmt::format(", price {:.3f} s", *price);
    if (!client.empty()) text += ", for " + client;
    if (!token.empty()) text += ", token " + token;
    text += ", request " + ids.request;
    if (ids.trace)
        text += fmt::format(", trace {} span {} of {}", ids.trace->trace, ids.span, ids.trace->parent);
    return plainLine(text);
}

nlohmann::json RequestRecord::fields(Clock::time_point now) const {
    nlohmann::json json{
        {"event", name(event)}, {"route", route}, {"status", status}, {"request", ids.request}};
    const auto put = [&json](const char* key, const std::string& value) {
        if (!value.empty()) json[key] = value;
    };
    put("method", method);
    put("path", target);
    put("client", client);
    put("token", token);
    put("session", session);
    put("note", note);
    if (event != Event::StreamOpened) {
        json["bytes"] = bytes;
        json["ms"] = rounded(millisecondsSince(begun, now));
    }
    if (event == Event::StreamEnded) json["frames"] = frames;
    if (price) json["price"] = rounded(*price);
    if (ids.trace) {
        json["trace"] = ids.trace->trace;
        json["parent"] = ids.trace->parent;
        json["span"] = ids.span;
        json["sampled"] = ids.trace->sampled;
    }
    return json;
}

}  // namespace scancast
