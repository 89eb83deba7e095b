#include "threads/guarded.hpp"

#include <exception>
#include <new>
#include <string>

namespace scancast {
namespace {

Error described(std::string_view who) {
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return {ErrorCode::ResourceLimit,
                std::string(who) +
                    " did not get the memory that this takes; ask for less (a smaller picture, fewer "
                    "samples), or "
                    "try again later.",
                {}};
    } catch (const std::exception& e) {
        return {ErrorCode::Internal, std::string(who) + " failed: " + e.what(), {}};
    } catch (...) {
        return {ErrorCode::Internal,
                std::string(who) + " failed with something that is no exception of C++'s library.",
                {}};
    }
}

}  // namespace

Error errorOfException(std::string_view who) noexcept {
    try {
        return described(who);
    } catch (...) {
        return {ErrorCode::ResourceLimit, "Out of memory.", {}};  // short enough to need none
    }
}

}  // namespace scancast
