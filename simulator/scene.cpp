#include "simulator/scene.hpp"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "simulator/model.hpp"
#include "simulator/permutation.hpp"
#include "simulator/sampler.hpp"

namespace scancast {
namespace {

struct SceneEntry {
    SceneInfo info;
    Model (*make)();
};

constexpr std::array entries{
    SceneEntry{{"town", "streets, a square, houses, trees and a sign with text, 200 m x 200 m"}, makeTown},
    SceneEntry{{"room", "a furnished room with a mirror, and the mirrored points behind it"}, makeRoom},
    SceneEntry{{"sphere", "a unit sphere, coloured so that one sees which way it is turned"}, makeSphere},
    SceneEntry{{"plane", "a flat test chart: checkers and readable text"}, makePlane},
    SceneEntry{{"statue", "a draped figure of stone on a plinth with an inscription, 3.1 m high"},
               makeStatue},
    SceneEntry{{"cube", "sharp creases: six faces of six colours, finely patterned"}, makeCube},
    SceneEntry{{"torus", "a chequered ring, curved both ways, that hides parts of itself"}, makeTorus},
    SceneEntry{{"sign", "a board with text from 30 cm down to 1 cm, sampled in shaken rows"}, makeSign},
    SceneEntry{{"bridge", "a river under a deck with openings: pillars, a boat, things near and far"},
               makeBridge},
};

constexpr auto infos = [] {
    std::array<SceneInfo, entries.size()> all;
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = entries[i].info;
    return all;
}();

/// "town, room, … and bridge".
std::string namesOfScenes() {
    std::string names;
    for (std::size_t i = 0; i < infos.size(); ++i) {
        if (i > 0) names += i + 1 == infos.size() ? " and " : ", ";
        names += infos[i].name;
    }
    return names;
}

const SceneEntry* findScene(std::string_view name) {
    const auto* found =
        std::ranges::find(entries, name, [](const SceneEntry& entry) { return entry.info.name; });
    return found == entries.end() ? nullptr : found;
}

/// Where points can lie at all: boxes around all patches, plus what materials and noise may add.
std::array<glm::dvec3, 2> boundsOf(const Model& model, double noise) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const Patch& patch : model.patches) {
        auto [from, to] = patch.bounds();
        if (patch.mirror >= 0) {
            const Mirror& mirror = model.mirrors[std::size_t(patch.mirror)];
            const glm::dvec3 center = reflected(mirror, (from + to) * 0.5), half(glm::length(to - from) / 2);
            from = center - half;
            to = center + half;
        }
        low = glm::min(low, from);
        high = glm::max(high, to);
    }
    const double margin = model.largestRelief + noise * model.rangeNoise * PointRandom::bellLimit + 0.01;
    return {low - margin, high + margin};
}

/// More threads than cores gain nothing, and oneTBB complains about them.
int workers(int asked) {
    const int cores = tbb::info::default_concurrency();
    return asked > 0 ? std::min(asked, cores) : cores;
}

class SimulatedScan final : public PointSource {
  public:
    SimulatedScan(Model model, const SceneOptions& options)
        : model_(std::move(model)),
          options_(options),
          origin_(options.origin.value_or(model_.defaultOrigin)),
          arena_(workers(options.threads)),
          sampler_(
              arena_.execute([&] { return Sampler(model_, options.points, options.seed, options.noise); })),
          shuffle_(options.points, mixBits(options.seed, 0x5caff1eULL)) {
        header_.format = "simulated " + options.scene;
        header_.points = options.points;
        header_.attributes = model_.attributes;
        const auto bounds = boundsOf(model_, options.noise);
        header_.bounds = {{bounds[0] + origin_, bounds[1] + origin_}};
        round_.resize(std::size_t(arena_.max_concurrency()) * 4);
        next_.resize(round_.size());
        startRound();
    }
    ~SimulatedScan() noexcept override {
        try {
            arena_.execute([&] { group_.wait(); });
        } catch (const std::bad_alloc&) {
            // Nobody waits for these points any more.
        }
    }

    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }

    Expected<bool> read(PointBatch& batch) override {
        try {
            if (given_ == used_ && !nextRound()) {
                batch.clear();
                return false;
            }
        } catch (const std::bad_alloc&) {
            return fail(ErrorCode::ResourceLimit, "There is not enough memory to simulate the scan.");
        }
        std::swap(batch, round_[given_++]);
        return true;
    }

  private:
    /// A run of points that is generated in one go: at most one batch, and whole cells where they fit.
    struct Unit {
        std::uint64_t first = 0, last = 0;
    };

    Unit unitFrom(std::uint64_t first) const {
        const std::uint64_t end = std::min(options_.points, first + batchPoints);
        if (options_.order == PointOrder::Random || end == options_.points) return {first, end};
        const std::uint64_t whole = sampler_.cells().firstPoint(sampler_.cells().cellOf(end));
        return {first, whole > first ? whole : end};
    }

    /// Has the next round made in the background, while the one before is handed out.
    void startRound() {
        units_.clear();
        while (units_.size() < next_.size() && planned_ < options_.points) {
            units_.push_back(unitFrom(planned_));
            planned_ = units_.back().last;
        }
        arena_.execute([&] {
            group_.run([this] {
                tbb::parallel_for(std::size_t(0), units_.size(),
                                  [this](std::size_t i) { generate(units_[i], next_[i]); });
            });
        });
    }

    bool nextRound() {
        arena_.execute([&] { group_.wait(); });
        std::swap(round_, next_);
        used_ = units_.size();
        given_ = 0;
        if (used_ > 0) startRound();
        return used_ > 0;
    }

    void generate(const Unit& unit, PointBatch& batch) const {
        const std::size_t count = unit.last - unit.first;
        batch.clear();
        auto& positions = batch.position.doubles();
        positions.resize(count);
        batch.color.resize(count);
        batch.intensity.resize(count);
        batch.classification.resize(count);
        batch.normal.resize(count);
        const auto put = [&](std::size_t slot, const ScanPoint& point) {
            positions[slot] = point.position + origin_;
            batch.color[slot] = point.color;
            batch.intensity[slot] = point.intensity;
            batch.classification[slot] = point.classification;
            batch.normal[slot] = point.normal;
        };
        std::vector<std::pair<std::uint64_t, std::uint32_t>> order(count);
        if (options_.order == PointOrder::Random) {
            // Made in the order of the cells, which caches like, and put where the shuffle wants them.
            for (std::size_t i = 0; i < count; ++i) order[i] = {shuffle_(unit.first + i), std::uint32_t(i)};
            std::ranges::sort(order);
            for (const auto& [index, slot] : order) put(slot, sampler_.point(index));
            return;
        }
        std::vector<ScanPoint> points(count);
        for (std::size_t i = 0; i < count; ++i) {
            points[i] = sampler_.point(unit.first + i);
            order[i] = {points[i].beam, std::uint32_t(i)};
        }
        std::ranges::sort(order);
        for (std::size_t i = 0; i < count; ++i) put(i, points[order[i].second]);
    }

    Model model_;
    SceneOptions options_;
    glm::dvec3 origin_;
    tbb::task_arena arena_;
    Sampler sampler_;
    Permutation shuffle_;
    ScanHeader header_;
    std::vector<PointBatch> round_, next_;  ///< being handed out; being made
    std::vector<Unit> units_;               ///< of next_
    std::uint64_t planned_ = 0;
    std::size_t given_ = 0, used_ = 0;
    tbb::task_group group_;
};

}  // namespace

std::span<const SceneInfo> scenes() {
    return infos;
}

Expected<std::unique_ptr<PointSource>> simulate(const SceneOptions& options) {
    const SceneEntry* scene = findScene(options.scene);
    if (!scene)
        return fail(ErrorCode::NotFound,
                    "There is no scene '" + options.scene + "'; there are " + namesOfScenes() + ".", "scene");
    // Above this a double no longer tells neighbouring point numbers apart.
    constexpr std::uint64_t mostPoints = 1'000'000'000'000;
    if (options.points == 0 || options.points > mostPoints)
        return fail(ErrorCode::InvalidArgument,
                    "The number of points must be between 1 and 1 000 000 000 000.", "points");
    if (!(options.noise >= 0 && options.noise <= 1000))
        return fail(ErrorCode::InvalidArgument, "The noise factor must be between 0 and 1000.", "noise");
    if (options.threads < 0 || options.threads > 4096)
        return fail(ErrorCode::InvalidArgument, "The number of threads must be between 0 and 4096.",
                    "threads");
    if (options.origin)
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs((*options.origin)[axis]) <= 1e9))
                return fail(ErrorCode::InvalidArgument, "The origin's coordinates must be within 1e9 of 0.",
                            "origin");
    try {
        return std::make_unique<SimulatedScan>(scene->make(), options);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, "There is not enough memory to simulate the scan.");
    }
}

std::optional<Model> makeScene(std::string_view name) {
    const SceneEntry* scene = findScene(name);
    return scene ? std::optional(scene->make()) : std::nullopt;
}

std::vector<Mirror> sceneMirrors(const SceneOptions& options) {
    const SceneEntry* scene = findScene(options.scene);
    if (!scene) return {};
    Model model = scene->make();
    for (Mirror& mirror : model.mirrors) mirror.center += options.origin.value_or(model.defaultOrigin);
    return std::move(model.mirrors);
}

}  // namespace scancast
