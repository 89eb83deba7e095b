// How much memory the machine has: what limits are made from where nobody names one. Pure function; any thread.
#pragma once

#include <unistd.h>

#include <cstdint>

namespace scancast {

/// Bytes of physical memory, whatever is in use.
inline std::uint64_t machineMemory() {
    return std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

}  // namespace scancast
