// Where exceptions end: what a library or an allocation throws becomes an error of ours, so that it fails the
// one request that it is about and not the thread, or the program. Every thread's loop and every callback
// into another room stands behind one of these. Pure functions; any thread.
#pragma once

#include <string_view>
#include <type_traits>
#include <utility>

#include "protocol/error.hpp"

namespace scancast {

/// The exception that is being handled, inside of a catch block: ResourceLimit where memory ran out, else
/// Internal. `who` begins the sentence: "The renderer".
Error errorOfException(std::string_view who) noexcept;

namespace detail {

template <class Result>
struct Guarded {
    using type = Expected<Result>;
};
template <class Value>
struct Guarded<Expected<Value>> {
    using type = Expected<Value>;
};

}  // namespace detail

/// What `work` returns (an Expected as it is), or what it threw as an error, of which `tell(error)` is told
/// first.
template <class Work, class Tell>
auto guarded(std::string_view who, Work&& work, const Tell& tell) ->
    typename detail::Guarded<std::decay_t<decltype(work())>>::type {
    try {
        if constexpr (std::is_void_v<decltype(work())>) {
            work();
            return {};
        } else {
            return std::forward<Work>(work)();
        }
    } catch (...) {
        Error error = errorOfException(who);
        tell(error);
        return tl::unexpected(std::move(error));
    }
}

template <class Work>
auto guarded(std::string_view who, Work&& work) {
    return guarded(who, std::forward<Work>(work), [](const Error&) {});
}

}  // namespace scancast
