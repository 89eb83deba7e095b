// Lets calls of the operating system fail in the program under test, as disks and networks do when they are broken, full or
// gone: the n-th read, write, open, ... says what a test wants, or moves fewer bytes than it was asked to. The product knows
// nothing of it: a test program is linked with `--wrap` for each call (tests/faults/CMakeLists.txt), so that its own
// code, static libraries and headers that are compiled into it call system_faults.cpp instead. Shared libraries are not
// reached: what std::filesystem does goes through.
//
// *Thread safety*: calls may come from any thread; one Faults at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scancast::test {

/// Calls that fail alike are one kind: read is read(), pread(), ...
enum class Call : std::uint8_t {
    Open,
    Read,
    Write,
    Sync,
    Rename,
    Truncate,
    Lock,
    Status,
    Duplicate,
    Map,
    Pipe,
    Spawn,
    Poll,
    Accept,
    Receive,
    Send,
    Allocate,  ///< operator new: failing_allocation.hpp
};
inline constexpr std::size_t callKinds = std::size_t(Call::Allocate) + 1;

struct Fault {
    enum class Effect : std::uint8_t {
        Fails,  ///< once, with `error`
        Stays,  ///< from then on every call of the kind fails so: a full disk stays full
        Short,  ///< what transfers bytes moves half of them, one at least
        Kills,  ///< a write moves half of its bytes, to a sector's border; a rename does nothing; and nothing changes any file from then on: as if the process
                ///< had been killed, or the machine had lost its power
        Jumps,  ///< the clock that people read (CLOCK_REALTIME) is `error` days off from then on
    };
    Call call = Call::Read;
    std::uint64_t nth = 1;  ///< from 1
    Effect effect = Effect::Fails;
    int error = 0;

    bool operator==(const Fault&) const = default;
};
/// "read:3:EIO", "write:1:short", "write:2:ENOSPC+" (stays), "write:5:kill", "allocate:9", several joined by commas.
std::string nameOf(const std::vector<Fault>& faults);
/// Its inverse; nullopt for what is none.
std::optional<std::vector<Fault>> parseFaults(std::string_view text);

/// Whose calls fail, and are counted.
enum class Whose : std::uint8_t { Everybodys, OtherThreads };

/// While it lives, these faults happen; at most eight. With none, it only counts.
class Faults {
  public:
    Faults(const std::vector<Fault>& faults, Whose whose, std::size_t leastAllocation = 0);
    ~Faults();
    Faults(const Faults&) = delete;
    Faults& operator=(const Faults&) = delete;

    /// How many of them have happened.
    int happened() const;
    /// Calls of that kind up to now.
    std::uint64_t calls(Call call) const;
};

/// Descriptors that this process has open.
std::size_t openDescriptors();

}  // namespace scancast::test
