#include "client/cpp/guest.hpp"

#include <nlohmann/json.hpp>

#include "client/cpp/http_get.hpp"
#include "protocol/guests/guest.hpp"
#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast::client {
namespace {

constexpr std::uint64_t longestPass = std::uint64_t{16} << 10u;

Expected<void> readPass(std::string_view text, GuestEntry& entry) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    FieldReader fields(*value, {}, ErrorCode::Malformed);
    std::uint64_t seconds = 0;
    if (fields.require("token")) fields.text("token", entry.credentials.token, 1024);
    if (fields.require("cloud")) fields.text("cloud", entry.cloud);
    if (fields.require("expiresInSeconds")) fields.integer("expiresInSeconds", seconds, 0, longestGuestLink);
    entry.expires = std::chrono::seconds(seconds);
    fields.flag("mayExport", entry.mayExport);
    return fields.finishLenient();
}

}  // namespace

bool isGuestLink(std::string_view text) {
    return guestAddress(text).has_value();
}

Expected<GuestEntry> enterAsGuest(std::string_view link, const Timeouts& timeouts,
                                  const std::filesystem::path& authority) {
    const auto address = guestAddress(link);
    if (!address)
        return fail(ErrorCode::InvalidArgument,
                    "This is no guest's link: it has no #guest=… at its end; copy all of it.");
    auto url = parseServerUrl(address->address);
    if (!url) return passOn(std::move(url));
    GuestEntry entry{std::move(*url), {{}, authority}, {}, {}};
    const std::string target = "/api/v1/guest-session";
    const auto answer =
        httpPostJson(entry.url, target, longestPass, printJson(nlohmann::json{{"token", address->token}}),
                     entry.credentials, timeouts);
    if (!answer) return passOn(answer);
    if (auto read =
            readPass({reinterpret_cast<const char*>(answer->body.data()), answer->body.size()}, entry);
        !read)
        return fail(ErrorCode::Malformed, entry.url.authority() + target + ": " + read.error().message);
    return entry;
}

}  // namespace scancast::client
