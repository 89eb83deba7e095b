// One HTTP request whose answer is handed over while it comes: of any length, within the memory of a piece. Boost.Beast stays in
// the .cpp.
//
// Free functions that block their thread until the answer's end, an error, or a deadline.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/cpp/credentials.hpp"
#include "client/cpp/server_url.hpp"
#include "client/cpp/timeouts.hpp"

namespace scancast::client {

struct StreamedAnswer {
    int status = 0;
    std::uint64_t bytes = 0;
    std::vector<std::pair<std::string, std::string>> headers{};  ///< as they came, trailers behind them

    /// Of those with this name, in upper or lower case, joined by ", "; empty where there is none.
    std::string header(std::string_view name) const;
};

/// Gets the body's next bytes; what it refuses with ends the request.
using TakeBytes = std::function<Expected<void>(std::span<const std::byte>)>;

/// Errors: those of httpGet(); Truncated where the answer breaks off before its end - what has been taken is not all; take's
/// own. Timeouts::answer holds for the head, and for each piece.
Expected<StreamedAnswer> httpPostStreamed(const ServerUrl& url, const std::string& target, std::string json,
                                          std::string_view accept, const Credentials& credentials,
                                          const Timeouts& timeouts, const TakeBytes& take);
/// The same of a GET.
Expected<StreamedAnswer> httpGetStreamed(const ServerUrl& url, const std::string& target,
                                         std::string_view accept, const Credentials& credentials,
                                         const Timeouts& timeouts, const TakeBytes& take);

}  // namespace scancast::client
