#include "server/catalog/memory_room.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string_view>

namespace scancast {
namespace {

constexpr std::uint64_t MiB = 1 << 20;

std::optional<std::uint64_t> numberIn(const std::string& path) {
    std::ifstream file(path);
    std::uint64_t value = 0;
    if (file >> value) return value;
    return std::nullopt;  // "max", or there is no such file
}

/// Of lines such as "MemAvailable:   1234 kB" or "inactive_file 1234".
std::optional<std::uint64_t> numberAfter(const std::string& path, std::string_view key) {
    std::ifstream file(path);
    std::string word;
    while (file >> word) {
        std::uint64_t value = 0;
        if (word == key && file >> value) return value;
    }
    return std::nullopt;
}

/// Where the limits of this process's control group (version 2) stand.
std::string groupFolder() {
    std::ifstream file("/proc/self/cgroup");
    std::string line;
    while (std::getline(file, line))
        if (line.rfind("0::", 0) == 0) return "/sys/fs/cgroup" + line.substr(3) + "/";
    return "/sys/fs/cgroup/";
}

void askGroup(MemoryFacts& facts) {
    const std::string folder = groupFolder();
    facts.groupLimit = numberIn(folder + "memory.max");
    if (!facts.groupLimit) return;
    facts.groupUsed = numberIn(folder + "memory.current");
    if (!facts.groupUsed) return;
    for (const char* files : {"inactive_file", "active_file"})  // given back when memory is needed
        *facts.groupUsed -=
            std::min(*facts.groupUsed, numberAfter(folder + "memory.stat", files).value_or(0));
}

void narrow(MemoryRoom& room, std::uint64_t bytes, std::string limit) {
    if (bytes < room.bytes) room = {bytes, std::move(limit)};
}

std::string inMiB(std::uint64_t bytes) {
    return fmt::format("{} MiB", bytes / MiB);
}

std::uint64_t left(std::uint64_t limit, std::uint64_t used) {
    return limit - std::min(limit, used);
}

}  // namespace

MemoryFacts memoryFacts() {
    MemoryFacts facts;
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        facts.addressLimit = limit.rlim_cur;
    if (const auto pages = numberIn("/proc/self/statm"))
        facts.addressUsed = *pages * std::uint64_t(::sysconf(_SC_PAGESIZE));
    if (const auto kib = numberAfter("/proc/meminfo", "MemAvailable:")) facts.available = *kib * 1024;
    askGroup(facts);
    return facts;
}

MemoryRoom roomOf(const MemoryFacts& facts) {
    MemoryRoom room;
    if (facts.available) narrow(room, *facts.available, "the memory of this machine");
    if (facts.groupLimit && facts.groupUsed)
        narrow(room, left(*facts.groupLimit, *facts.groupUsed),
               "the memory limit of its control group, " + inMiB(*facts.groupLimit));
    if (facts.addressLimit && facts.addressUsed)
        narrow(room, left(*facts.addressLimit, *facts.addressUsed),
               "the limit of its address space (RLIMIT_AS), " + inMiB(*facts.addressLimit));
    return room;
}

Expected<void> checkRoom(const View& view, std::uint64_t needed, const MemoryRoom& room) {
    if (needed <= room.bytes) return {};
    return fail(
        ErrorCode::ResourceLimit,
        fmt::format(
            "A picture of {} x {} pixels takes about {} of memory, and this server has {} left below {}; "
            "ask for a smaller one, or again when fewer are being drawn.",
            view.width, view.height, inMiB(needed), inMiB(room.bytes), room.limit),
        "width");
}

}  // namespace scancast
