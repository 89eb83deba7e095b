#include "files/machine.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

namespace scancast {
namespace {

namespace fs = std::filesystem;

/// That version 1 writes where there is none, and more.
constexpr std::uint64_t noLimit = std::uint64_t(1) << 60;

std::string textOf(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::size_t entriesOf(const char* folder) {
    std::error_code error;
    std::size_t entries = 0;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        ++entries;
    return entries;
}

template <class T>
std::optional<T> numberIn(const fs::path& path) {
    std::istringstream text(textOf(path));
    T value{};
    if (text >> value) return value;
    return std::nullopt;  // "max", or there is no such file
}

template <class T>
void narrow(std::optional<T>& limit, std::optional<T> other) {
    if (other && (!limit || *other < *limit)) limit = other;
}

std::optional<double> cores(double quota, double period) {
    if (!(quota > 0) || !(period > 0)) return std::nullopt;
    return quota / period;
}

void narrowByVersion2(GroupLimits& limits, const fs::path& folder) {
    narrow(limits.memory, numberIn<std::uint64_t>(folder / "memory.max"));
    std::istringstream text(textOf(folder / "cpu.max"));  // "150000 100000", or "max 100000"
    double quota = 0, period = 0;
    if (text >> quota >> period) narrow(limits.cores, cores(quota, period));
}

void narrowMemoryByVersion1(GroupLimits& limits, const fs::path& folder) {
    const auto bytes = numberIn<std::uint64_t>(folder / "memory.limit_in_bytes");
    if (bytes && *bytes < noLimit) narrow(limits.memory, bytes);
}

void narrowCoresByVersion1(GroupLimits& limits, const fs::path& folder) {
    const auto quota = numberIn<double>(folder / "cpu.cfs_quota_us");
    const auto period = numberIn<double>(folder / "cpu.cfs_period_us");
    if (quota && period) narrow(limits.cores, cores(*quota, *period));
}

/// The group and all that it is in, up to where they are mounted; within a container only the last may be there.
template <class Narrow>
void upwards(const fs::path& mount, const std::string& group, const Narrow& narrow) {
    for (fs::path at = fs::path(group).relative_path().lexically_normal();; at = at.parent_path()) {
        narrow(mount / at);
        if (at.empty()) return;
    }
}

bool names(const std::string& controllers, const std::string& one) {
    return ("," + controllers + ",").find("," + one + ",") != std::string::npos;
}

GroupLimits ownGroupLimits() {
    return groupLimits("/sys/fs/cgroup", textOf("/proc/self/cgroup"));
}

}  // namespace

GroupLimits groupLimits(const fs::path& root, const std::string& membership) {
    GroupLimits limits;
    std::istringstream lines(membership);
    for (std::string line; std::getline(lines, line);) {  // "0::/a/b", "4:cpu,cpuacct:/a/b"
        const auto first = line.find(':');
        const auto second = first == std::string::npos ? first : line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1),
                          group = line.substr(second + 1);
        if (group.find("..") != std::string::npos) continue;  // not below what is mounted here
        if (controllers.empty())
            upwards(root, group, [&](const fs::path& folder) { narrowByVersion2(limits, folder); });
        if (names(controllers, "memory"))
            upwards(root / "memory", group,
                    [&](const fs::path& folder) { narrowMemoryByVersion1(limits, folder); });
        if (names(controllers, "cpu"))
            upwards(root / "cpu", group,
                    [&](const fs::path& folder) { narrowCoresByVersion1(limits, folder); });
    }
    return limits;
}

std::uint64_t machineMemory() {
    const auto all = std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE));
    return std::min(all, ownGroupLimits().memory.value_or(all));
}

std::uint64_t residentMemory() {
    std::istringstream text(textOf("/proc/self/statm"));
    std::uint64_t all = 0, resident = 0;
    text >> all >> resident;
    return resident * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

std::uint64_t heapMemory() {
    const struct mallinfo2 info = ::mallinfo2();
    return std::uint64_t(info.uordblks) + std::uint64_t(info.hblkhd);
}

std::size_t openFileCount() {
    const std::size_t withItself = entriesOf("/proc/self/fd");
    return withItself > 0 ? withItself - 1 : 0;
}

std::size_t threadCount() {
    return entriesOf("/proc/self/task");
}

int machineCores() {
    const int all = int(std::max(1u, std::thread::hardware_concurrency()));
    const auto granted = ownGroupLimits().cores;
    return granted ? std::clamp(int(std::ceil(*granted)), 1, all) : all;
}

}  // namespace scancast
