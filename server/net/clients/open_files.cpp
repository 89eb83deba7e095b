#include "server/net/clients/open_files.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <limits>

namespace scancast {
namespace {

constexpr std::size_t shortRequests = 448;  // beside sessions, where nobody says how many
constexpr std::size_t fewestShortRequests = 16;
constexpr std::uint64_t ownFiles = 384;

}  // namespace

std::uint64_t raiseFileLimit(std::uint64_t wanted) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return std::numeric_limits<std::uint64_t>::max();
    if (limit.rlim_cur >= wanted) return limit.rlim_cur;
    rlimit raised = limit;
    raised.rlim_cur = std::min<rlim_t>(wanted, limit.rlim_max);
    // Refused where a sandbox forbids the call: then what was allowed before still is.
    return ::setrlimit(RLIMIT_NOFILE, &raised) == 0 ? raised.rlim_cur : limit.rlim_cur;
}

std::size_t ConnectionWish::connections() const {
    return asked.value_or(sessions + shortRequests);
}

std::uint64_t ConnectionWish::files(std::size_t connections) const {
    return connections + 2 * clouds + ownFiles;
}

Expected<std::size_t> fittingConnections(const ConnectionWish& wish, std::uint64_t fileLimit) {
    if (wish.asked && *wish.asked < wish.sessions) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("--max-connections {}: fewer than --max-sessions {}, each of which is a "
                                "connection; allow more connections, or fewer sessions.",
                                *wish.asked, wish.sessions),
                    "max-connections");
    }
    const std::size_t connections = wish.connections();
    if (wish.files(connections) <= fileLimit) return connections;
    const std::uint64_t beside = wish.files(0);
    const std::size_t fit = fileLimit > beside ? std::size_t(fileLimit - beside) : 0;
    if (!wish.asked && fit >= wish.sessions + fewestShortRequests) return fit;
    const std::string flag = wish.asked ? "max-connections" : "max-sessions";
    const std::size_t least = wish.asked ? connections : wish.sessions + fewestShortRequests;
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("--{} {}: with all else that is a file, {} have to be open, and this process may "
                    "have {}. Raise that limit (ulimit -Hn in a shell, LimitNOFILE= of a systemd unit, "
                    "--ulimit nofile= of a container){}.",
                    flag, wish.asked ? connections : wish.sessions, wish.files(least), fileLimit,
                    fit > fewestShortRequests
                        ? fmt::format(", or allow fewer: {} connections fit, {} of them streams", fit,
                                      std::min(wish.sessions, fit - fewestShortRequests))
                        : ""),
        flag);
}

}  // namespace scancast
