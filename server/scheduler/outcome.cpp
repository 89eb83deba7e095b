#include "server/scheduler/outcome.hpp"

namespace scancast {

Error cancelled() {
    return Error{ErrorCode::Cancelled, "The picture is not wanted any more.", {}};
}

Error tooLate() {
    return Error{
        ErrorCode::DeadlineExceeded,
        "The picture was not ready in time: the server is busy, or the view is too costly. Ask for a smaller "
        "picture, fewer samples or a coarser detail.",
        {}};
}

Error errorOf(const Turns::Request& request) {
    switch (request.end) {
        case Turns::End::Late:
            return tooLate();
        case Turns::End::Lacking:
            return Error{ErrorCode::Cancelled, "Samples of this picture are still to be read.", {}};
        case Turns::End::Failed:
            return *request.error;
        default:
            return cancelled();
    }
}

std::optional<DropReason> dropReason(Turns::End end) {
    switch (end) {
        case Turns::End::Overwritten:
            return DropReason::Overwritten;
        case Turns::End::Abandoned:
            return DropReason::Abandoned;
        case Turns::End::Gone:
            return DropReason::Gone;
        case Turns::End::Late:
            return DropReason::Deadline;
        case Turns::End::Lacking:
            return DropReason::Lacking;
        case Turns::End::Failed:
            return DropReason::Failed;
        default:
            return std::nullopt;
    }
}

}  // namespace scancast
