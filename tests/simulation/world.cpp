#include "tests/simulation/world.hpp"

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "tests/simulation/simulated_clients.hpp"
#include "tests/simulation/simulated_clouds.hpp"

namespace scancast::simulation {
namespace {

class World {
  public:
    World(std::uint64_t seed, const Machine& machine) : chance_(seed), server_(time_, chance_, machine) {}

    Chance& chance() { return chance_; }
    SimulatedServer& server() { return server_; }
    SimulatedViewer& addViewer(const Link& link, const Hand& hand) {
        viewers_.push_back(std::make_unique<SimulatedViewer>(++clients_, server_, time_, chance_, clouds_,
                                                             metrics_, link, hand));
        return *viewers_.back();
    }
    void addFetcher(const Appetite& appetite) {
        fetchers_.push_back(std::make_unique<SimulatedFetcher>(++clients_, server_, time_, chance_,
                                                               *clouds_.cloud(""), appetite));
    }
    void run(double seconds) {
        const Time end = time_.now() + milliseconds(seconds * 1000);
        while (!server_.violation() && time_.step(end)) {
        }
    }
    /// Everybody rests, and what was asked for is waited for.
    void calmDown() {
        server_.calmDown();
        for (const auto& viewer : viewers_) viewer->calmDown();
        for (const auto& fetcher : fetchers_) fetcher->calmDown();
        run(120);
        if (!server_.idle()) server_.violate("two minutes after everything, something is still being made");
        for (const auto& viewer : viewers_)
            if (!viewer->satisfied()) server_.violate(viewer->state());
    }
    std::uint64_t events() const { return time_.events(); }
    std::size_t viewers() const { return viewers_.size(); }

  private:
    VirtualTime time_;
    Chance chance_;
    Metrics metrics_{"simulation"};
    const SimulatedClouds clouds_;
    // Who asks is told what became of it, at the latest when the server ends.
    std::vector<std::unique_ptr<SimulatedViewer>> viewers_;
    std::vector<std::unique_ptr<SimulatedFetcher>> fetchers_;
    SimulatedServer server_;
    int clients_ = 0;
};

Link someLink(Chance& chance) {
    Link link;
    link.delayMs = chance.scale(0.5, 300);
    link.bytesPerMs = chance.scale(100, 50000);
    if (chance.happens(0.3)) link.pausesPerMinute = chance.between(2, 30);
    if (chance.happens(0.3)) link.cutsPerMinute = chance.between(2, 20);
    return link;
}

Hand someHand(Chance& chance) {
    Hand hand;
    hand.viewsPerSecond = chance.between(5, 80);
    hand.movesMs = chance.scale(50, 8000);
    hand.restsMs = chance.scale(50, 8000);
    hand.width = int(chance.scale(200, 3840));
    hand.height = hand.width * 9 / 16;
    hand.samples = 1 << chance.below(5);
    return hand;
}

Appetite someAppetite(Chance& chance) {
    Appetite appetite;
    appetite.client = fmt::format("client {}", chance.below(3));
    appetite.pauseMs = chance.scale(1, 5000);
    appetite.width = int(chance.scale(100, 6000));
    appetite.height = appetite.width * 9 / 16;
    appetite.samples = 1 << chance.below(5);
    appetite.png = chance.happens(0.2);
    appetite.impatience = chance.happens(0.5) ? chance.unit() : 0;
    return appetite;
}

}  // namespace

Outcome simulate(std::uint64_t seed, double seconds) {
    Chance lots(seed);
    const Machine machine = someMachine(lots);
    World world(lots.bits(), machine);
    const int viewers = 1 + lots.below(6), fetchers = lots.below(5);
    for (int i = 0; i < viewers; ++i) {
        const Link link = someLink(lots);
        world.addViewer(link, someHand(lots));
    }
    for (int i = 0; i < fetchers; ++i) world.addFetcher(someAppetite(lots));
    world.run(seconds);
    world.calmDown();
    Outcome outcome;
    outcome.violation = world.server().violation();
    outcome.population = fmt::format(
        "{} viewers, {} fetchers; a device that {}, {:.1f} ms a megapixel, lost {} times; {:.0f} % of views "
        "are "
        "read in {:.0f} ms, {:.0f} stalls a minute",
        viewers, fetchers, machine.pauses ? "pauses" : "does not pause", machine.perMegapixel,
        world.server().lost(), machine.coldViews * 100, machine.loadMs, machine.stallsPerMinute);
    outcome.seconds = seconds;
    outcome.sessionSeconds = seconds * viewers;
    outcome.events = world.events();
    outcome.pictures = world.server().drawn();
    outcome.within = world.server().within();
    outcome.devicesLost = world.server().lost();
    outcome.longestWaitMs = world.server().longestWait();
    return outcome;
}

Beside politeBeside(Load load, int others, double seconds) {
    Machine machine;
    machine.coldViews = 0;
    machine.badGuess = 1;
    World world(1, machine);
    const Link link{5, 20000};
    const double always = 10 * seconds * 1000;
    const Hand polite{60, always, 1, 960, 540, 4};
    SimulatedViewer& viewer = world.addViewer(link, polite);
    for (int i = 0; i < others; ++i) {
        switch (load) {
            case Load::PoliteViewers:
                world.addViewer(link, polite);
                break;
            case Load::CostlyViewers:
                world.addViewer(link, {60, always, 1, 3840, 2160, 16});
                break;
            case Load::CostlySnapshots:
                world.addFetcher({fmt::format("client {}", i), 1, 3840, 2160, 16, i % 2 == 1, 0});
                break;
        }
    }
    world.run(seconds);
    return {viewer.longestGapMs(), double(viewer.frames()) / seconds};
}

}  // namespace scancast::simulation
