#include "protocol/problem.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/text/plain_text.hpp"

namespace scancast {
namespace {

constexpr std::string_view typePrefix = "urn:scancast:problem:";

std::string_view title(ErrorCode code) {
    switch (code) {
        case ErrorCode::InvalidArgument:
            return "A parameter is malformed or out of range";
        case ErrorCode::ImpossibleView:
            return "No picture can be made of this view";
        case ErrorCode::NotFound:
            return "There is no such thing here";
        case ErrorCode::Malformed:
            return "The input does not follow its format";
        case ErrorCode::Truncated:
            return "The input ends too early";
        case ErrorCode::Empty:
            return "The scan has no points";
        case ErrorCode::Unsupported:
            return "This server does not do that";
        case ErrorCode::Io:
            return "The operating system refused";
        case ErrorCode::Unavailable:
            return "What this comes from cannot be reached at present";
        case ErrorCode::Importer:
            return "An importer failed";
        case ErrorCode::ResourceLimit:
            return "This is larger than the server allows";
        case ErrorCode::Cancelled:
            return "The work was abandoned";
        case ErrorCode::DeadlineExceeded:
            return "This took longer than the server allows";
        case ErrorCode::DeviceUnavailable:
            return "The rendering device is not available";
        case ErrorCode::DeviceLost:
            return "The rendering device was lost";
        case ErrorCode::Internal:
            return "A fault of the server";
    }
    return "A fault of the server";
}

}  // namespace

int httpStatus(ErrorCode code) {
    switch (code) {
        case ErrorCode::InvalidArgument:
        case ErrorCode::Malformed:
        case ErrorCode::Truncated:
            return 400;
        case ErrorCode::NotFound:
            return 404;
        case ErrorCode::ResourceLimit:
            return 413;
        case ErrorCode::ImpossibleView:
        case ErrorCode::Empty:
        case ErrorCode::Unsupported:
            return 422;
        case ErrorCode::Cancelled:
        case ErrorCode::Unavailable:
        case ErrorCode::DeviceUnavailable:
        case ErrorCode::DeviceLost:
            return 503;
        case ErrorCode::DeadlineExceeded:
            return 504;
        case ErrorCode::Io:
        case ErrorCode::Importer:
        case ErrorCode::Internal:
            return 500;
    }
    return 500;
}

std::string_view reasonPhrase(int status) {
    switch (status) {
        case 200:
            return "OK";
        case 202:
            return "Accepted";
        case 204:
            return "No Content";
        case 304:
            return "Not Modified";
        case 400:
            return "Bad Request";
        case 401:
            return "Unauthorized";
        case 403:
            return "Forbidden";
        case 404:
            return "Not Found";
        case 405:
            return "Method Not Allowed";
        case 406:
            return "Not Acceptable";
        case 408:
            return "Request Timeout";
        case 409:
            return "Conflict";
        case 413:
            return "Content Too Large";
        case 414:
            return "URI Too Long";
        case 415:
            return "Unsupported Media Type";
        case 421:
            return "Misdirected Request";
        case 422:
            return "Unprocessable Content";
        case 426:
            return "Upgrade Required";
        case 429:
            return "Too Many Requests";
        case 431:
            return "Request Header Fields Too Large";
        case 500:
            return "Internal Server Error";
        case 501:
            return "Not Implemented";
        case 503:
            return "Service Unavailable";
        case 504:
            return "Gateway Timeout";
        case 505:
            return "HTTP Version Not Supported";
        default:
            return "Unknown";
    }
}

Problem problemOf(const Error& error, std::string instance) {
    Problem problem;
    problem.type = std::string(typePrefix) + std::string(name(error.code));
    problem.title = title(error.code);
    problem.status = httpStatus(error.code);
    problem.detail = error.message;
    problem.instance = std::move(instance);
    if (!error.field.empty()) problem.errors.push_back({error.field, error.message});
    return problem;
}

Problem problemOf(int status, std::string detail, std::string instance) {
    Problem problem;
    problem.title = reasonPhrase(status);
    problem.status = status;
    problem.detail = std::move(detail);
    problem.instance = std::move(instance);
    return problem;
}

Error errorOf(const Problem& problem) {
    Error error{ErrorCode::Internal, plainText(problem.detail.empty() ? problem.title : problem.detail), {}};
    if (!problem.requestId.empty()) error.message += " (request " + plainLine(problem.requestId) + ")";
    if (!problem.errors.empty()) error.field = problem.errors.front().parameter;
    for (int code = 0; code <= static_cast<int>(ErrorCode::Internal); ++code) {
        error.code = static_cast<ErrorCode>(code);
        if (problem.type.starts_with(typePrefix) &&
            problem.type.substr(typePrefix.size()) == name(error.code))
            return error;
    }
    switch (problem.status) {
        case 404:
            error.code = ErrorCode::NotFound;
            break;
        case 413:
        case 429:
            error.code = ErrorCode::ResourceLimit;
            break;
        case 422:
            error.code = ErrorCode::ImpossibleView;
            break;
        case 503:
            error.code = ErrorCode::DeviceUnavailable;
            break;
        case 504:
            error.code = ErrorCode::DeadlineExceeded;
            break;
        default:
            error.code = problem.status < 500 ? ErrorCode::InvalidArgument : ErrorCode::Internal;
    }
    return error;
}

nlohmann::json toJson(const Problem& problem) {
    nlohmann::json object = {{"type", problem.type},
                             {"title", problem.title},
                             {"status", problem.status},
                             {"detail", problem.detail}};
    if (!problem.instance.empty()) object["instance"] = problem.instance;
    for (const auto& cause : problem.errors)
        object["errors"].push_back({{"parameter", cause.parameter}, {"detail", cause.detail}});
    if (problem.cost) {
        object["price"] = std::round(problem.cost->price);
        object["limit"] = std::round(problem.cost->limit);
        if (!problem.cost->nearest.empty()) object["nearest"] = problem.cost->nearest;
    }
    if (!problem.requestId.empty()) object["requestId"] = problem.requestId;
    return object;
}

Expected<Problem> problemFromJson(const nlohmann::json& value) {
    constexpr std::size_t longestText = 4096, mostCauses = 256;
    Problem problem;
    FieldReader fields(value, {}, ErrorCode::Malformed);
    fields.text("type", problem.type, longestText);
    fields.text("title", problem.title, longestText);
    fields.integer("status", problem.status, 100, 599);
    fields.text("detail", problem.detail, longestText);
    fields.text("instance", problem.instance, longestText);
    fields.text("requestId", problem.requestId, longestText);
    if (const auto* errors = fields.findValue("errors")) {
        if (!errors->is_array() || errors->size() > mostCauses)
            fields.error("errors", "expected a short array");
        else
            for (const auto& item : *errors) {
                auto& cause = problem.errors.emplace_back();
                FieldReader entry(item, "errors", ErrorCode::Malformed);
                entry.text("parameter", cause.parameter, longestText);
                entry.text("detail", cause.detail, longestText);
                if (auto sound = entry.finishLenient(); !sound) fields.error(sound.error());
            }
    }
    Problem::Cost cost;
    if (fields.number("price", cost.price) && fields.number("limit", cost.limit)) {
        const auto* nearest = fields.findValue("nearest");
        if (nearest != nullptr && nearest->is_object() && nearest->size() <= mostCauses)
            for (const auto& [word, number] : nearest->items())
                if (number.is_number()) cost.nearest[word] = number.get<double>();
        problem.cost = std::move(cost);
    }
    if (auto ok = fields.finishLenient(); !ok) return passOn(ok);
    return problem;
}

}  // namespace scancast
