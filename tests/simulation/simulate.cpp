// Plays the server in virtual time: `simulate` takes a hundred seeds, `simulate --seeds 10000` as many; a seed
// that fails replays exactly with `simulate --seed N`. README.md says what is simulated and what is checked.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "tests/simulation/world.hpp"

namespace {

using namespace scancast::simulation;

std::string replay(std::uint64_t seed, double seconds) {
    return fmt::format("simulate --seed {} --seconds {:g}", seed, seconds);
}

/// Whether a polite viewer hardly notices what others ask for; prints how it is for him.
bool politeIsServed() {
    bool good = true;
    fmt::print("{:<36} {:>6} {:>15} {:>10} {:>18}\n", "polite viewer (960 x 540) beside", "others",
               "longest gap, ms", "frames/s", "among as many, /s");
    for (const int others : {0, 1, 4, 8}) {
        const Beside among = politeBeside(Load::PoliteViewers, others, 20);
        for (const auto& [load, name] : {std::pair(Load::CostlyViewers, "viewers of 3840 x 2160"),
                                         std::pair(Load::CostlySnapshots, "snapshots of 3840 x 2160 x 16")}) {
            if (others == 0 && load != Load::CostlyViewers) continue;
            const Beside beside = politeBeside(load, others, 20);
            const bool served =
                beside.longestGapMs <= 500 && beside.framesPerSecond >= among.framesPerSecond / 2;
            fmt::print("{:<36} {:>6} {:>15.0f} {:>10.1f} {:>18.1f}{}\n", others == 0 ? "nobody" : name,
                       others, beside.longestGapMs, beside.framesPerSecond, among.framesPerSecond,
                       served ? "" : "   TOO LITTLE");
            good = good && served;
        }
    }
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Plays the server in virtual time, and looks for what must never be."};
    std::uint64_t seeds = 100, first = 1, one = 0;
    double seconds = 20;
    app.add_option("--seeds", seeds, "How many worlds")->capture_default_str();
    app.add_option("--first", first, "The first one's seed")->capture_default_str();
    app.add_option("--seed", one, "Only this one, and tell more");
    app.add_option("--seconds", seconds, "Virtual time until everybody rests")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    if (one != 0) {
        const Outcome outcome = simulate(one, seconds);
        fmt::print(
            "seed {}: {}\n{} events, {} pictures, {} of them within others; longest wait of a moving frame "
            "{:.0f} ms\n{}\n",
            one, outcome.population, outcome.events, outcome.pictures, outcome.within, outcome.longestWaitMs,
            outcome.violation.value_or("nothing wrong"));
        return outcome.violation ? 1 : 0;
    }
    const auto start = std::chrono::steady_clock::now();
    std::uint64_t wrong = 0, events = 0, pictures = 0, within = 0, lost = 0;
    double sessionSeconds = 0, longest = 0;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
        const Outcome outcome = simulate(seed, seconds);
        events += outcome.events;
        pictures += outcome.pictures;
        within += outcome.within;
        lost += outcome.devicesLost;
        sessionSeconds += outcome.sessionSeconds;
        longest = std::max(longest, outcome.longestWaitMs);
        if (!outcome.violation) continue;
        ++wrong;
        fmt::print("seed {}: {}\n  {}\n  again: {}\n", seed, *outcome.violation, outcome.population,
                   replay(seed, seconds));
    }
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    fmt::print(
        "{} worlds of {:g} s, {} of them wrong: {} events, {} pictures, {} drawn within others, {} devices "
        "lost; longest wait of a moving frame {:.0f} ms; {:.0f} seconds of sessions a second\n",
        seeds, seconds, wrong, events, pictures, within, lost, longest, sessionSeconds / took);
    const bool served = politeIsServed();
    return wrong == 0 && served ? 0 : 1;
}
