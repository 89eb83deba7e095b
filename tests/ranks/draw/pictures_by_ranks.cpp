// mpirun -n N pictures_by_ranks CLOUD.scan: pictures of a cloud file in every method, drawn by all ranks and by rank 0 alone, have the
// same bytes. The cloud has to show a mirror in its first view. Says how many pictures there were, or what differs (exit code 1).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "ranks/draw/rank_resources.hpp"
#include "ranks/draw/ranks_device.hpp"
#include "ranks/mpi/session.hpp"
#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "renderer/plan.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/ranks/draw/what_travels.hpp"

namespace scancast {
namespace {

constexpr std::uint64_t memory = 64 << 20;

std::shared_ptr<BlockCache> cacheOf(std::uint64_t limit) {
    BlockCacheOptions options;
    options.memoryLimit = limit;
    return BlockCache::create(options);
}

class Comparison {
  public:
    Comparison(Device& together, const Cloud& shared, Device& alone, const Cloud& whole)
        : together_(together), shared_(shared), alone_(alone), whole_(whole) {}

    void compare(const View& view, std::string_view what) {
        ++pictures_;
        const auto a = render(together_, shared_, view), b = render(alone_, whole_, view);
        if (!a || !b) return fault(view, what, !a ? a.error().message : b.error().message);
        const bool colours = std::ranges::equal(a->rgba, b->rgba);
        const bool depths = a->depth.size() == b->depth.size() &&
                            std::memcmp(a->depth.data(), b->depth.data(), 4 * b->depth.size()) == 0;
        if (!colours || !depths) fault(view, what, colours ? "depths differ" : "colours differ");
        if (b->stats.mirrorsDrawn != (view.style.mirrors ? 1u : 0u))
            fault(view, what, "the mirror is not seen");
        const auto seen = std::ranges::count_if(b->depth, [](float d) { return std::isfinite(d); });
        if (seen * 20 < std::ptrdiff_t(b->depth.size())) fault(view, what, "there is nothing in the picture");
    }
    /// The same, of a view that has to be another picture than `other`.
    void compareOther(const View& view, const View& other, std::string_view what) {
        const auto a = render(alone_, whole_, view), b = render(alone_, whole_, other);
        if (a && b && std::ranges::equal(a->rgba, b->rgba)) fault(view, what, "it changes nothing");
        compare(view, what);
    }
    int pictures() const { return pictures_; }
    int faults() const { return faults_; }

  private:
    void fault(const View& view, std::string_view what, std::string_view why) {
        ++faults_;
        fmt::print(stderr, "{}, {}: {}\n", view.style.method, what, why);
    }
    Device& together_;
    const Cloud& shared_;
    Device& alone_;
    const Cloud& whole_;
    int pictures_ = 0, faults_ = 0;
};

/// Abandoned before and while they are drawn; whoever is asked for the next one is there.
int abandoned(Device& device, const Cloud& cloud, const View& view) {
    int faults = 0;
    for (int i = 0; i < 20; ++i) {
        std::stop_source stop;
        std::jthread hand([&] {
            std::this_thread::sleep_for(std::chrono::microseconds(400 * i));
            stop.request_stop();
        });
        const auto frame = render(device, cloud, view, {}, stop.get_token());
        faults += !frame && frame.error().code != ErrorCode::Cancelled;
    }
    if (faults > 0) fmt::print(stderr, "{} abandoned pictures ended otherwise\n", faults);
    return faults;
}

/// In its pauses another picture is drawn, by all ranks; neither shows it.
int withinPauses(Comparison& comparison, Device& together, const Cloud& shared, Device& alone,
                 const Cloud& whole, View view) {
    view.width = 800;
    view.height = 500;
    view.style.method = "ewa";
    View other = view;
    other.width = 120;
    other.height = 80;
    int pauses = 0;
    const Pause pause = [&] {
        if (pauses++ < 2) comparison.compare(other, "within a pause");
    };
    const auto planned = plan(shared, view);
    const auto prepared =
        planned ? prepare(shared, *planned) : Expected<std::shared_ptr<const PreparedView>>(passOn(planned));
    auto begun = prepared ? beginDrawing(together, **prepared, {}, Uploads::Everything, &pause)
                          : Expected<std::unique_ptr<PendingFrame>>(passOn(prepared));
    const auto a = begun ? (*begun)->finish() : Expected<Frame>(passOn(begun));
    const auto b = render(alone, whole, view);
    if (a && b && std::ranges::equal(a->rgba, b->rgba) && pauses > 0) return 0;
    fmt::print(stderr, "a picture with {} pauses is another\n", pauses);
    return 1;
}

/// What decides which samples are drawn, and how they become colours, is the same on all ranks.
void filtered(Comparison& comparison, const View& first) {
    View plain = first;
    plain.quality.samples = 1;
    plain.style.method = "hqs";
    View view = plain;
    view.style.clip = ClipBox{glm::dvec3(-1e6), {first.camera.target.x, 1e6, 1e6}};
    view.style.mirrors = false;
    View bare = plain;
    bare.style.mirrors = false;
    comparison.compareOther(view, bare, "clipped");
    view.style.clip.reset();
    view.style.clips = {TurnedBox{first.camera.target, {1e4, 20, 1e4}, {30, 0, 0}},
                        TurnedBox{first.camera.target, {4, 4, 4}, {0, 20, 0}, true}};
    comparison.compareOther(view, bare, "cut by shapes");
    view = plain;
    view.style.color = ColorSource::Rgb;
    view.style.byIntensity = true;
    comparison.compareOther(view, plain, "by intensity");
    view = plain;
    view.style.color = ColorSource::Curvature;
    comparison.compareOther(view, plain, "curvature");
    view = plain;
    view.style.exposure = 1.5;
    comparison.compareOther(view, plain, "toned");
    view = plain;
    view.style.outliers = Outliers::Show;
    comparison.compare(view, "with outliers");
}

/// A file that is another one by the time that the others open it is rank 0's alone: the right picture, and no error.
Expected<int> whereOthersHaveAnother(const Communicator& ranks, const std::shared_ptr<SharedClouds>& clouds,
                                     Device& together, Device& alone, const Cloud& whole,
                                     const std::string& path, const RankTraffic& traffic) {
    const std::string copy = path + "-replaced.scan";
    std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
    const auto file = CloudFile::open(std::filesystem::path(copy));
    if (!file) return passOn(file);
    std::filesystem::remove(copy);
    std::ofstream(copy) << "no cloud any more";
    const auto opened = openCloud(*file, clouds);
    std::filesystem::remove(copy);
    if (!opened) return passOn(opened);
    clouds->know(*opened);
    const std::uint64_t before = traffic.bytes;
    Comparison comparison(together, **opened, alone, whole);
    comparison.compare(defaultView(whole, 120, 80), "where others have another file");
    if (ranks.size() > 1 && traffic.bytes != before) fmt::print(stderr, "another file is drawn together\n");
    return comparison.faults() + int(ranks.size() > 1 && traffic.bytes != before);
}

Expected<int> compareAll(const Communicator& ranks, const Communicator& opening, const std::string& path) {
    const auto clouds =
        std::make_shared<SharedClouds>(cacheOf(memory), NodeShare{0, std::uint32_t(ranks.size())}, opening,
                                       [](const std::string& sentence) { fmt::print("{}\n", sentence); });
    const auto shared = openCloud(path, clouds);
    if (!shared) return passOn(shared);
    const auto whole = openCloud(path, cacheOf(memory * std::uint64_t(ranks.size())));
    if (!whole) return passOn(whole);
    clouds->know(*shared);
    RankTraffic traffic;
    auto together = createRanksDevice(ranks, clouds, 1, traffic);
    if (!together) return passOn(together);
    auto alone = createCpuDevice(2);
    if (!alone) return passOn(alone);
    Comparison comparison(**together, **shared, **alone, **whole);
    const View first = defaultView(**whole, 211, 131);
    for (const Method& method : methods()) {
        View view = first;
        view.style.method = method.name;
        view.quality.samples = 4;
        comparison.compare(view, "4 samples");
        if (ranks.size() != 3) continue;  // three show what else there is
        view.quality.samples = 1;
        view.style.shading = Shading::Phong;
        view.style.light.sun = {{200, 50}};
        view.style.light.shadow = 0.8;
        view.style.light.occlusion = 0.5;
        comparison.compare(view, "lit");
        view.style.mirrors = false;  // only then each rank finishes rows of its own
        view.quality.samples = 4;
        comparison.compare(view, "lit, without a mirror, 4 samples");
        if (method.name != "paraboloid") continue;
        view = first;
        view.style.method = method.name;
        view.style.mirrors = false;
        view.quality.samples = 1;
        view.style.parameters["smooth"] = true;
        comparison.compare(view, "smooth");
    }
    const bool two = ranks.size() == 2;
    if (two) filtered(comparison, first);
    // Larger than a tile (renderer/prepare.hpp).
    View poster = first;
    poster.width = 2100;
    poster.height = 60;
    poster.quality.samples = 1;
    if (two) comparison.compare(poster, "in tiles");
    int faults = 0;
    for (const bool mirrors : {true, false}) {
        View view = first;
        view.style.mirrors = mirrors;
        faults += abandoned(**together, **shared, view);
        comparison.compare(view, "after those that were abandoned");
        if (ranks.size() > 1)
            faults += withinPauses(comparison, **together, **shared, **alone, **whole, view);
    }
    const auto others = whereOthersHaveAnother(ranks, clouds, **together, **alone, **whole, path, traffic);
    if (!others) return others;
    faults += *others + everythingTravels();
    clouds->close();
    fmt::print("{} ranks, {} pictures, {} differ; {} bytes reduced\n", ranks.size(), comparison.pictures(),
               comparison.faults(), traffic.bytes);
    if (ranks.size() > 1 && traffic.bytes == 0) ++faults;
    return faults + comparison.faults();
}

int run(const std::string& path) {
    yieldWhileWaiting();
    auto mpi = MpiSession::start({});
    if (!mpi) return 1;
    const Communicator& ranks = (*mpi)->world();
    const Communicator opening(ranks.handle(), {});
    const int wrong = spansArrive(ranks);
    if (!ranks.isFirst()) {
        OpenedClouds clouds(cacheOf(memory), {std::uint32_t(ranks.rank()), std::uint32_t(ranks.size())},
                            opening);
        return drawWithFirst(ranks, clouds, 1) && wrong == 0 ? 0 : 1;
    }
    const auto faults = compareAll(ranks, opening, path);
    if (!faults) fmt::print(stderr, "{}\n", faults.error().message);
    if (!letGo(ranks, opening)) return 1;
    return faults && *faults == 0 && wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace scancast

int main(int argc, char** argv) {
    if (argc == 2) return scancast::run(argv[1]);
    fmt::print(stderr, "pictures_by_ranks CLOUD.scan\n");
    return 2;
}
