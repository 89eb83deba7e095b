#include "remote/answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace scancast {
namespace {

constexpr std::size_t longestValue = 1024;
constexpr std::string_view noSuchObject = "there is no such object";

std::string_view trimmed(std::string_view text) {
    const auto isBlank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
    return text;
}

bool isSame(std::string_view text, std::string_view lower) {
    return std::ranges::equal(text, lower,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

/// Takes digits off `text`.
bool takeNumber(std::string_view& text, std::uint64_t& into) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), into);
    if (error != std::errc() || end == text.data()) return false;
    text.remove_prefix(std::size_t(end - text.data()));
    return true;
}

bool take(std::string_view& text, std::string_view what) {
    if (!text.starts_with(what)) return false;
    text.remove_prefix(what.size());
    return true;
}

bool isPrintable(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return c >= 0x20 && c < 0x7f; });
}

std::optional<std::chrono::seconds> secondsOf(std::string_view text) {
    std::uint64_t seconds = 0;
    constexpr std::uint64_t longest = 3600;
    if (!takeNumber(text, seconds) || !text.empty()) return std::nullopt;  // a date: our own waiting will do
    return std::chrono::seconds(std::min(seconds, longest));
}

RequestFault faultOf(const AnswerHead& head, std::string_view body, bool isOpen) {
    const std::string code = s3ErrorCode(body);
    RequestFault fault{RequestFault::Kind::Refused,
                       fmt::format("it answers {}{}", head.status, code.empty() ? "" : " " + code)};
    if (head.status == 416 && !isOpen) {
        fault.kind = RequestFault::Kind::Unsuitable;
        fault.text = "it is empty";
    } else if (isOpen && (head.status == 412 || head.status == 416)) {
        fault.kind = RequestFault::Kind::Changed;
        fault.text = "it has been replaced by another";
    } else if (head.status == 408 || head.status == 425 || head.status == 429 || head.status >= 500) {
        fault.kind = RequestFault::Kind::Unreachable;
        fault.after = secondsOf(head.retryAfter);
    } else if (head.status == 200) {
        fault.kind = RequestFault::Kind::Unsuitable;
        fault.text = "its server sends all of it where a part was asked for (it must support range requests)";
    } else if (head.status >= 300 && head.status < 400) {
        fault.text += ", a redirection that is not followed";
    } else if (head.status == 404 || head.status == 410) {
        fault.text.append(": ").append(noSuchObject);
    } else if (head.status == 401 || head.status == 403) {
        fault.text += ": that is not allowed with these credentials, or not any more";
    }
    return fault;
}

}  // namespace

bool RequestFault::isMissing() const {
    return kind == Kind::Refused && text.ends_with(noSuchObject);
}

std::optional<ContentRange> parseContentRange(std::string_view text) {
    ContentRange range;
    text = trimmed(text);
    if (text.size() < 6 || !isSame(text.substr(0, 5), "bytes") || text[5] != ' ') return std::nullopt;
    text = trimmed(text.substr(6));
    if (!takeNumber(text, range.first) || !take(text, "-") || !takeNumber(text, range.last) ||
        !take(text, "/") || !takeNumber(text, range.total) || !text.empty())
        return std::nullopt;
    if (range.first > range.last || range.last >= range.total) return std::nullopt;
    return range;
}

std::string s3ErrorCode(std::string_view body) {
    constexpr std::size_t longest = 64;
    const auto at = body.find("<Code>");
    if (at == body.npos) return {};
    const auto rest = body.substr(at + 6);
    const auto code = rest.substr(0, std::min(rest.find('<'), rest.size()));
    if (code.empty() || code.size() > longest || code.size() == rest.size()) return {};
    const bool isCode = std::ranges::all_of(code, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    });
    return isCode ? std::string(code) : std::string();
}

std::string ObjectState::strongTag() const {
    const bool isStrong = etag.size() >= 2 && etag.front() == '"' && etag.back() == '"';
    return isStrong ? etag : std::string();
}

void AnswerHead::add(std::string_view line) {
    if (line.starts_with("HTTP/")) {
        *this = {};
        const auto blank = std::min(line.find(' '), line.size());
        std::uint64_t number = 0;
        std::string_view rest = trimmed(line.substr(blank));
        if (takeNumber(rest, number) && number < 1000) status = long(number);
        return;
    }
    const auto colon = line.find(':');
    if (colon == line.npos) return;
    const std::string_view name = line.substr(0, colon), value = trimmed(line.substr(colon + 1));
    if (value.size() > longestValue || !isPrintable(value)) return;
    for (const auto& [known, into] : {std::pair(std::string_view("content-range"), &contentRange),
                                      {"content-encoding", &contentEncoding},
                                      {"etag", &etag},
                                      {"last-modified", &lastModified},
                                      {"retry-after", &retryAfter}})
        if (isSame(name, known)) *into = value;
}

tl::expected<ObjectState, RequestFault> judge(const AnswerHead& head, std::uint64_t first,
                                              std::uint64_t bytes, const ObjectState* expected,
                                              std::string_view body) {
    const auto unsuitable = [](std::string text) {
        return tl::unexpected(RequestFault{RequestFault::Kind::Unsuitable, std::move(text)});
    };
    if (head.status != 206) return tl::unexpected(faultOf(head, body, expected != nullptr));
    if (!head.contentEncoding.empty() && !isSame(head.contentEncoding, "identity"))
        return unsuitable("its server compresses it on the way, so that parts of it cannot be read");
    const auto range = parseContentRange(head.contentRange);
    if (!range) return unsuitable("its server does not say which part it sends (no sound Content-Range)");
    ObjectState state{range->total, head.etag, head.lastModified};
    if (expected && state != *expected)
        return tl::unexpected(RequestFault{RequestFault::Kind::Changed, "it has been replaced by another"});
    if (bytes == 0 || range->first != first ||
        range->last != first + std::min(bytes, range->total - first) - 1)
        return unsuitable("its server sends another part than was asked for");
    return state;
}

tl::expected<ObjectState, RequestFault> judgeWhole(const AnswerHead& head, std::string_view body) {
    if (head.status != 200) return tl::unexpected(faultOf(head, body, false));
    if (!head.contentEncoding.empty() && !isSame(head.contentEncoding, "identity"))
        return tl::unexpected(
            RequestFault{RequestFault::Kind::Unsuitable, "its server compresses it, and was asked not to"});
    return ObjectState{0, head.etag, head.lastModified};
}

}  // namespace scancast
