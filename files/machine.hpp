// How much memory and how many cores this process may use: what limits are made from where nobody names one. The
// machine's, or less where a control group (version 1 or 2: containers, units of systemd) grants less.
// Functions that read a few small files; any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace scancast {

/// Bytes that may be in use at the most, whatever is in use.
std::uint64_t machineMemory();
/// At least 1. A quota of one and a half is two.
int machineCores();
/// `threads`, or where it is 0 as many as machineCores().
inline int coresOf(int threads) {
    return threads > 0 ? threads : machineCores();
}
/// Bytes that this process has in memory now.
std::uint64_t residentMemory();
/// Bytes that this process has asked its allocator for and not given back; 0 where that does not tell.
std::uint64_t heapMemory();
/// Descriptors that this process has open, that of looking not counted; 0 where the system does not tell.
std::size_t openFileCount();
/// Threads of this process; 0 where the system does not tell.
std::size_t threadCount();

/// What the control groups of a process grant, the tightest of those that it is in; nullopt = all that there is.
struct GroupLimits {
    std::optional<std::uint64_t> memory;  ///< bytes
    std::optional<double> cores;
};
/// `root`: where control groups are mounted; `membership`: the text of /proc/self/cgroup.
GroupLimits groupLimits(const std::filesystem::path& root, const std::string& membership);

}  // namespace scancast
