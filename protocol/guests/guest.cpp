#include "protocol/guests/guest.hpp"

#include <charconv>
#include <ctime>

#include "protocol/bearer.hpp"
#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast {

Expected<GuestLinkRequest> parseGuestLinkRequest(std::string_view text) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    GuestLinkRequest asked;
    FieldReader fields(*value);
    if (fields.require("cloud")) fields.text("cloud", asked.cloud);
    if (fields.require("expiresInSeconds"))
        fields.integer("expiresInSeconds", asked.seconds, shortestGuestLink, longestGuestLink);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return asked;
}

Expected<std::string> parseGuestSessionRequest(std::string_view text) {
    const auto value = parseJson(text);
    // Not what the parser says of it, which may quote the token.
    if (!value) return fail(ErrorCode::Malformed, "This is not JSON; send {\"token\": \"…\"}.");
    std::string token;
    FieldReader fields(*value);
    if (fields.require("token")) fields.text("token", token, longestToken);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return token;
}

std::string utcText(std::chrono::system_clock::time_point time) {
    const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
    std::tm parts{};
    ::gmtime_r(&seconds, &parts);
    char text[32];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

std::string guestPath(std::string_view token) {
    return "/#" + std::string(guestFragmentWord) + std::string(token);
}

std::optional<GuestAddress> guestAddress(std::string_view url) {
    const auto hash = url.find('#');
    if (hash == std::string_view::npos) return std::nullopt;
    std::string_view rest = url.substr(hash + 1);
    while (!rest.empty()) {
        const auto end = rest.find('&');
        const std::string_view word = rest.substr(0, end);
        if (word.starts_with(guestFragmentWord))
            return GuestAddress{std::string(url.substr(0, hash)),
                                std::string(word.substr(guestFragmentWord.size()))};
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    }
    return std::nullopt;
}

Expected<std::uint64_t> parseGuestTime(std::string_view text) {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view unit(end, std::size_t(text.data() + text.size() - end));
    const std::uint64_t seconds = unit == "s"   ? 1
                                  : unit == "m" ? 60
                                  : unit == "h" ? 3600
                                  : unit == "d" ? 24 * 3600
                                                : 0;
    if (error != std::errc() || seconds == 0)
        return fail(ErrorCode::InvalidArgument, "must be a time like 90m, 12h or 7d");
    if (number > longestGuestLink / seconds || number * seconds < shortestGuestLink)
        return fail(ErrorCode::InvalidArgument, "must be from 60s to 366d");
    return number * seconds;
}

}  // namespace scancast
