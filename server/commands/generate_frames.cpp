#include "server/commands/generate_frames.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <glm/common.hpp>
#include <numbers>
#include <thread>

#include "files/output_file.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast {
namespace {

using FrameClock = std::chrono::steady_clock;

struct SceneInMemory {
    std::vector<PointBatch> chunks;
    glm::dvec3 middle{0};
};

Expected<SceneInMemory> readScene(PointSource& source) {
    SceneInMemory scene;
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    PointBatch batch;
    for (;;) {
        const auto more = source.read(batch);
        if (!more) return passOn(more);
        if (!*more) break;
        for (const glm::dvec3& p : batch.position) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        scene.chunks.push_back(std::move(batch));
        batch = {};
    }
    scene.middle = (low + high) * 0.5;
    return scene;
}

Expected<void> writeFrame(const SceneInMemory& scene, const ScanHeader& header, double degrees,
                          OutputFile& output) {
    PointStreamWriter writer(
        [&](std::span<const std::byte> bytes) { return output.write(bytes).has_value(); });
    if (auto ok = writer.writeHeader(header); !ok) return ok;
    for (const PointBatch& chunk : scene.chunks)
        if (auto ok = writer.writeChunk(turned(chunk, scene.middle, degrees)); !ok) return ok;
    if (auto ok = writer.finish(0); !ok) return ok;
    return output.flush();
}

}  // namespace

PointBatch turned(const PointBatch& points, const glm::dvec3& middle, double degrees) {
    const double angle = std::fmod(degrees, 360.0) * std::numbers::pi / 180;
    const double c = std::cos(angle), s = std::sin(angle);
    PointBatch result = points;
    for (glm::dvec3& p : result.position.doubles()) {
        const glm::dvec3 d = p - middle;
        p = middle + glm::dvec3(c * d.x - s * d.y, s * d.x + c * d.y, d.z);
    }
    result.normal.clear();
    return result;
}

Expected<std::uint64_t> writeFrames(PointSource& source, const std::string& output, const FrameSeries& series,
                                    const std::function<bool()>& interrupted) {
    std::signal(SIGPIPE, SIG_IGN);  // it is an error of write() then
    const auto scene = readScene(source);
    if (!scene) return passOn(scene);
    ScanHeader header = source.header();
    header.bounds.reset();  // of the scene as it stands
    header.gridStep = glm::dvec3(0);
    header.attributes.normal = false;
    auto file = OutputFile::create(output);
    if (!file) return passOn(file);
    const auto begun = FrameClock::now();
    std::uint64_t frame = 0;
    for (; series.frames == 0 || frame < series.frames; ++frame) {
        if (series.rate > 0)
            std::this_thread::sleep_until(begun +
                                          std::chrono::duration_cast<FrameClock::duration>(
                                              std::chrono::duration<double>(double(frame) / series.rate)));
        if (interrupted()) {
            if (series.frames == 0) return frame;
            return fail(ErrorCode::Cancelled, "Interrupted after " + std::to_string(frame) + " frames.");
        }
        if (auto ok = writeFrame(*scene, header, double(frame) * series.turn, *file); !ok) {
            if (series.frames == 0) return frame;
            return passOn(ok);
        }
    }
    if (auto ok = file->finish(); !ok) return passOn(ok);
    return frame;
}

}  // namespace scancast
