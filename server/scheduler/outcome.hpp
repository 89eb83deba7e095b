// How pictures end that nobody gets to see. Pure functions; any thread.
#pragma once

#include <exception>
#include <string>

#include "protocol/error.hpp"

namespace scancast {

inline Error cancelled() {
    return Error{ErrorCode::Cancelled, "The picture is not wanted any more.", {}};
}

inline Error tooLate() {
    return Error{
        ErrorCode::DeadlineExceeded,
        "The picture was not ready in time: the server is busy, or the view is too costly. Ask for a smaller "
        "picture, fewer samples or a coarser detail.",
        {}};
}

/// A request must not take the server down: what escapes the renderer, out of memory for one, fails one
/// picture.
template <class Work>
auto guarded(Work work) -> decltype(work()) {
    try {
        return work();
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, std::string("The renderer failed: ") + e.what());
    }
}

}  // namespace scancast
