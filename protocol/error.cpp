#include "protocol/error.hpp"

namespace scancast {

std::string_view name(ErrorCode code) {
    switch (code) {
        case ErrorCode::InvalidArgument:
            return "invalid-argument";
        case ErrorCode::ImpossibleView:
            return "impossible-view";
        case ErrorCode::NotFound:
            return "not-found";
        case ErrorCode::Malformed:
            return "malformed";
        case ErrorCode::Truncated:
            return "truncated";
        case ErrorCode::Empty:
            return "empty";
        case ErrorCode::Unsupported:
            return "unsupported";
        case ErrorCode::Io:
            return "io";
        case ErrorCode::Unavailable:
            return "unavailable";
        case ErrorCode::Importer:
            return "importer";
        case ErrorCode::ResourceLimit:
            return "resource-limit";
        case ErrorCode::Cancelled:
            return "cancelled";
        case ErrorCode::DeadlineExceeded:
            return "deadline-exceeded";
        case ErrorCode::DeviceUnavailable:
            return "device-unavailable";
        case ErrorCode::DeviceLost:
            return "device-lost";
        case ErrorCode::Internal:
            return "internal";
    }
    return "internal";
}

}  // namespace scancast
