// What holds whatever the bytes are: a fuzzer takes the end of the program for what it is, a fault.
#pragma once

#include <cstdlib>

inline void require(bool holds) {
    if (!holds) std::abort();
}
