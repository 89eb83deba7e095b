// A whole server and everybody who uses it, drawn by lot from a seed, for a while of virtual time. What
// happens is the same for the same seed, on every machine.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace scancast::simulation {

struct Outcome {
    std::optional<std::string> violation;    ///< what must not have been
    std::string population;                  ///< who was there, for people
    double seconds = 0, sessionSeconds = 0;  ///< of virtual time
    std::uint64_t events = 0, pictures = 0, within = 0, devicesLost = 0;
    double longestWaitMs = 0;  ///< of a moving frame for its turn
};

/// `seconds`: until everybody rests; then all must come to an end.
Outcome simulate(std::uint64_t seed, double seconds);

/// A polite viewer, who moves a camera over pictures of 960 x 540, beside so many others of a kind.
struct Beside {
    double longestGapMs = 0, framesPerSecond = 0;
};
enum class Load { PoliteViewers, CostlyViewers, CostlySnapshots };
Beside politeBeside(Load load, int others, double seconds);

}  // namespace scancast::simulation
