#include "files/system_error.hpp"

#include <cerrno>
#include <system_error>

namespace scancast {

std::string systemReason(int error) {
    return std::generic_category().message(error);
}

bool isFull(int error) {
    return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

std::string wayOutOfFull(int error) {
    if (error == EFBIG) return "let files become larger (ulimit -f) or choose another place";
    return "free some space or choose another place";
}

}  // namespace scancast
