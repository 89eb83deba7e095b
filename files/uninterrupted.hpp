// A call of the system, made again for as long as a signal interrupts it: -1 with EINTR is no failure. Any thread.
#pragma once

#include <cerrno>

namespace scancast {

template <class Call>
auto uninterrupted(Call call) {
    auto result = call();
    while (result == -1 && errno == EINTR) result = call();
    return result;
}

}  // namespace scancast
