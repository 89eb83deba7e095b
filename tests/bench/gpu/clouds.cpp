#include "tests/bench/gpu/clouds.hpp"

#include "server/catalog/memory_room.hpp"
#include "server/terminal/progress_bar.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/support/clouds/scene_clouds.hpp"

namespace scancast::bench {

BuiltForBench buildOrExit(const std::string& scene, std::uint64_t points, bool surfels) {
    const double needed = double(points) * double(bytesPerPoint);
    const MemoryRoom room = memoryRoom();
    std::fprintf(stderr, "Building %s: %s points %s surfels; takes up to %.2f GB of memory, ", scene.c_str(),
                 shortCount(double(points)).c_str(), surfels ? "with" : "without", needed / 1e9);
    if (room.limit.empty())
        std::fprintf(stderr, "how much is left is not told.\n");
    else
        std::fprintf(stderr, "%.2f GB are left.\n", double(room.bytes) / 1e9);
    if (needed > double(room.bytes)) {
        std::fprintf(stderr,
                     "This cloud of %s points does not fit in %s; name fewer, for example --points %lluM.\n",
                     shortCount(double(points)).c_str(), room.limit.c_str(),
                     static_cast<unsigned long long>(room.bytes / bytesPerPoint / 1'000'000));
        std::exit(1);
    }
    BuiltForBench built;
    {
        ProgressBar bar;
        built.seconds = timed([&] {
                            built.cloud = orExit(test::sceneCloud(scene, points, 16384, surfels, bar.sink()));
                        }) /
                        1000;
    }
    std::fprintf(stderr, "Built in %s, %s points a second.\n", shortDuration(built.seconds).c_str(),
                 shortCount(double(points) / built.seconds).c_str());
    return built;
}

}  // namespace scancast::bench
