// How much memory this process may still take, and whether a picture fits in: asked before a large one is
// begun, because where memory is only promised, the system kills who takes it.
//
// Pure functions but for memoryRoom(), which asks the system (some ten microseconds). Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/error.hpp"
#include "protocol/view/view.hpp"

namespace scancast {

struct MemoryRoom {
    std::uint64_t bytes = ~std::uint64_t(0);  ///< that may still be taken
    std::string limit{};                      ///< what ends it, for people: "the memory of this machine"
};

/// What the system says, each as it is; nullopt = it does not say, or there is no limit.
struct MemoryFacts {
    std::optional<std::uint64_t> addressLimit, addressUsed;  ///< RLIMIT_AS, and of that
    std::optional<std::uint64_t> available;                  ///< MemAvailable of /proc/meminfo
    std::optional<std::uint64_t> groupLimit,
        groupUsed;  ///< memory.max of the control group; files not counted
};

MemoryFacts memoryFacts();
/// The tightest of them.
MemoryRoom roomOf(const MemoryFacts& facts);
inline MemoryRoom memoryRoom() {
    return roomOf(memoryFacts());
}

/// Pictures up to this size come all the time and are not worth asking for.
inline constexpr std::int64_t smallPicturePixels = 2 << 20;
/// ResourceLimit, naming the limit, when the picture, which needs so many bytes, does not fit.
Expected<void> checkRoom(const View& view, std::uint64_t needed, const MemoryRoom& room);

}  // namespace scancast
