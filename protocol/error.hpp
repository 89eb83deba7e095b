// What went wrong, in one shape for every room: a code to act on, a sentence to read.
//
// Failures that can happen at run time travel as Expected<T>; programming errors assert. A message is one
// plain English sentence that names the thing (file, offset, parameter) and, where there is one, the way out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace scancast {

enum class ErrorCode : std::uint8_t {
    InvalidArgument,    ///< a parameter is malformed or out of range (HTTP 400)
    ImpossibleView,     ///< well formed, but no picture can be made of it: eye = target, NaN … (HTTP 422)
    NotFound,           ///< no such cloud, method, file (HTTP 404)
    Malformed,          ///< outside bytes that do not follow their format
    Truncated,          ///< outside bytes that end too early
    Empty,              ///< a well-formed scan without a single point
    Unsupported,        ///< well formed, but not something that this program does
    Io,                 ///< the operating system refused
    Unavailable,        ///< what it comes from cannot be reached at present; later it may (HTTP 503)
    Importer,           ///< an importer process crashed, hung or lied
    ResourceLimit,      ///< too large for a configured limit (HTTP 413 or 503)
    Cancelled,          ///< abandoned on request; nothing is wrong
    DeadlineExceeded,   ///< took longer than it was allowed to (HTTP 504)
    DeviceUnavailable,  ///< the rendering device does not exist here or cannot be opened
    DeviceLost,         ///< it was there and is gone
    Internal,           ///< a fault of ours
};

/// The code's name in kebab case, as it stands in problem details and logs: "invalid-argument".
std::string_view name(ErrorCode code);

struct Error {
    ErrorCode code = ErrorCode::Internal;
    std::string message;
    /// The parameter or JSON field at fault ("camera.fov"); empty when it is not about one.
    std::string field;
};

template <class T>
using Expected = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string message, std::string field = {}) {
    return tl::unexpected<Error>(Error{code, std::move(message), std::move(field)});
}

/// For `if (!x) return passOn(x);`: the same failure, of whatever this function would have returned.
template <class T, class E>
[[nodiscard]] tl::unexpected<E> passOn(const tl::expected<T, E>& failed) {
    return tl::unexpected<E>(failed.error());
}
template <class T, class E>
[[nodiscard]] tl::unexpected<E> passOn(tl::expected<T, E>&& failed) {
    return tl::unexpected<E>(std::move(failed.error()));
}

}  // namespace scancast
