// How pictures end that nobody gets to see. Pure functions; any thread.
#pragma once

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

}  // namespace scancast
