#include "tests/bench/gpu/measure.hpp"

#include <array>
#include <fstream>

#include "files/machine.hpp"
#include "renderer/image/encode.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/bench/gpu/open.hpp"
#include "tests/support/pictures/stability.hpp"

namespace scancast::bench {
namespace {

constexpr std::array<std::string_view, 3> hostStages{"select", "provide", "prepare"};
constexpr std::string_view wayBack = "read-back";

/// A slow row ends after so many seconds with fewer frames: a command has minutes.
constexpr double mostSeconds = 5;
constexpr int fewestFrames = 3;
/// The first frames of a row upload and compile.
constexpr int framesNotCounted = 2;

void savePng(const Frame& frame, const std::filesystem::path& name) {
    const Bytes bytes = orExit(encodePng(frame, false));
    std::ofstream file(name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (file.flush()) return;
    std::fprintf(stderr, "%s could not be written.\n", name.c_str());
    std::exit(1);
}

/// Of the first size only: others would fill the disk with the same picture.
std::filesystem::path pictureName(const Row& row, const Settings& s) {
    if (s.pictures.empty() || row.size != s.sizes[0]) return {};
    return s.pictures / (s.scene + "-" + std::to_string(row.points) + "-" + row.method +
                         (row.bruteForce ? "-brute-force.png" : ".png"));
}

Cost costOf(Device& device, const Cloud& cloud, View view, const RenderOptions& options, const Settings& s) {
    Cost cost;
    StageTimes stages;
    std::vector<double> frames, jpegs;
    double spent = 0;
    const double warmUp = s.warmUp * 1000;
    const int cores = coresOf(s.device.threads);
    for (int drawn = 0; cost.frames < s.repeat; ++drawn) {
        // Nothing of the frame before can be used again.
        view.camera = test::moved(view.camera, test::Motion::Orbit, 0.01);
        Frame frame;
        const double drawing = timed([&] { frame = orExit(render(device, cloud, view, options)); });
        const double encoding = timed([&] { orExit(encodeJpeg(frame, 90, Subsampling::S420, cores)); });
        spent += drawing + encoding;
        if (cost.frames == 0 && (drawn < framesNotCounted || spent < warmUp)) continue;
        if (cost.frames >= fewestFrames && spent > warmUp + mostSeconds * 1000) break;
        frames.push_back(drawing);
        jpegs.push_back(drawing + encoding);
        stages.add(frame.stats.stages);
        cost.samples = frame.stats.samplesDrawn;
        ++cost.frames;
    }
    cost.stages = stages.medians();
    cost.frame = median(frames);
    cost.jpeg = median(jpegs);
    return cost;
}

}  // namespace

double Cost::of(std::initializer_list<std::string_view> names) const {
    double sum = 0;
    for (const StageTime& stage : stages)
        if (std::ranges::find(names, stage.name) != names.end()) sum += stage.milliseconds;
    return sum;
}

double Cost::host() const {
    return of({hostStages[0], hostStages[1], hostStages[2]});
}

double Cost::gpu() const {
    double sum = 0;
    for (const StageTime& stage : stages)
        if (stage.name != wayBack && std::ranges::find(hostStages, stage.name) == hostStages.end())
            sum += stage.milliseconds;
    return sum;
}

std::string Row::title() const {
    return "`" + method + (bruteForce ? "`, brute force" : "`");
}

Row measureRow(Device& device, Device* truth, const Cloud& cloud, const View& view, Row row,
               const Settings& settings) {
    RenderOptions options{.bruteForce = row.bruteForce};
    const std::filesystem::path png = pictureName(row, settings);
    if (truth != nullptr || !png.empty()) {
        const Frame frame = orExit(render(device, cloud, view, options));
        if (!png.empty()) savePng(frame, png);
        if (truth != nullptr)
            row.agreement = test::agreementOf(orExit(render(*truth, cloud, view, options)), frame);
    }
    options.depth = false;  // as a server asks, which encodes colours alone
    const bool wrong = row.agreement && row.agreement->psnr < owedDecibels;
    if (!wrong || settings.anyway) row.cost = costOf(device, cloud, view, options, settings);
    return row;
}

}  // namespace scancast::bench
