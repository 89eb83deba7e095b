// What a moving frame takes as JPEG and as H.264 at equal distance from what was drawn: milliseconds of one core, bytes, PSNR, along
// an orbit of a generated town, as sessions draw it while it moves (one sample a pixel).
//
//     bench_video [--points 4000000] [--frames 90] [--degrees 1] [--method auto] [--match]
//
// --match prints, for each quality of JPEG, the QP that is as near to what was drawn: what quantiserFor() is made of.
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "renderer/image/encode.hpp"
#include "renderer/render.hpp"
#include "server/scheduler/video_stream.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "video/video_decoder.hpp"

namespace {

using namespace scancast;
using bench::orExit;

struct Cost {
    double ms = 0, bytes = 0, keyBytes = 0, psnr = 0;
    double rate(double framesPerSecond) const { return bytes * 8 * framesPerSecond / 1e6; }
};

/// Of RGBA against pixels of `step` bytes.
double squaredError(const Frame& frame, const std::uint8_t* pixels, std::size_t step) {
    double sum = 0;
    const std::size_t count = std::size_t(frame.width) * std::size_t(frame.height);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = double(frame.rgba.data()[4 * i + c]) - pixels[step * i + c];
            sum += difference * difference;
        }
    return sum / double(3 * count);
}

double decibels(double error) {
    return 10 * std::log10(255 * 255 / std::max(error, 1e-6));
}

Cost asJpeg(const std::vector<Frame>& frames, int quality) {
    std::vector<double> ms;
    Cost cost;
    for (const Frame& frame : frames) {
        Bytes bytes;
        ms.push_back(bench::timed([&] { bytes = orExit(encodeJpeg(frame, quality, Subsampling::S420)); }));
        cost.bytes += double(bytes.size()) / double(frames.size());
        const Frame back = orExit(decodeJpeg(bytes));
        cost.psnr += decibels(squaredError(frame, back.rgba.data(), 4)) / double(frames.size());
    }
    cost.ms = bench::median(ms);
    return cost;
}

/// The first frame, a key, is told apart: a walk has one.
Cost asVideo(const std::vector<Frame>& frames, int quantiser) {
    const auto encoder = orExit(VideoEncoder::open(frames.front().width, frames.front().height));
    const auto decoder = orExit(VideoDecoder::open());
    std::vector<double> ms;
    Cost cost;
    const double count = double(frames.size() - 1);
    for (const Frame& frame : frames) {
        VideoPicture picture;
        const double took = bench::timed([&] {
            picture = orExit(encoder->encode({frame.rgba.data(), frame.rgba.size()}, quantiser, false));
        });
        const auto back = orExit(decoder->decode(picture.bytes, frame.width, frame.height));
        if (picture.key) {
            cost.keyBytes = double(picture.bytes.size());
            continue;
        }
        ms.push_back(took);
        cost.bytes += double(picture.bytes.size()) / count;
        cost.psnr += decibels(squaredError(frame, back.data(), 3)) / count;
    }
    cost.ms = bench::median(ms);
    return cost;
}

void match(const std::vector<Frame>& frames) {
    std::vector<std::pair<int, Cost>> videos;
    for (int quantiser = 14; quantiser <= 46; quantiser += 2)
        videos.emplace_back(quantiser, asVideo(frames, quantiser));
    for (const auto& [quantiser, cost] : videos)
        std::printf("QP %d: %.2f dB, %.0f bytes, key %.0f\n", quantiser, cost.psnr, cost.bytes,
                    cost.keyBytes);
    for (const int quality : {10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95, 98}) {
        const Cost jpeg = asJpeg(frames, quality);
        double found = 0;
        for (std::size_t i = 1; i < videos.size(); ++i) {
            const double above = videos[i - 1].second.psnr, below = videos[i].second.psnr;
            if (above >= jpeg.psnr && below < jpeg.psnr)
                found = videos[i - 1].first + 2 * (above - jpeg.psnr) / (above - below);
        }
        std::printf("JPEG %d: %.2f dB, %.0f bytes = QP %.1f; quantiserFor() %d\n", quality, jpeg.psnr,
                    jpeg.bytes, found, quantiserFor(quality));
    }
}

std::vector<Frame> orbit(Device& device, const Cloud& cloud, int width, int height, int count, double degrees,
                         const std::string& method) {
    std::vector<Frame> frames;
    for (int i = 0; i < count; ++i) {
        View view = defaultView(cloud, width, height);
        view.style.method = method;
        view.quality.samples = 1;
        const double angle = i * degrees / 180 * 3.14159265358979;
        const auto from = view.camera.eye - view.camera.target;
        view.camera.eye.x = view.camera.target.x + from.x * std::cos(angle) - from.y * std::sin(angle);
        view.camera.eye.y = view.camera.target.y + from.x * std::sin(angle) + from.y * std::cos(angle);
        frames.push_back(orExit(render(device, cloud, view)));
    }
    return frames;
}

}  // namespace

int main(int argc, char** argv) {
    int points = 4'000'000, count = 90;
    double degrees = 1;
    std::string method = "auto";
    bool isMatch = false;
    bench::readOptions(argc, argv,
                       {bench::countOption("--points", points, 1000),
                        bench::countOption("--frames", count, 2),
                        {"--degrees", [&](const std::string& value) { degrees = std::atof(value.c_str()); }},
                        {"--method", [&](const std::string& value) { method = value; }},
                        bench::flagOption("--match", isMatch)},
                       "bench_video --points 4000000 --frames 90 --degrees 1 --method auto --match");
    const auto cloud = orExit(test::sceneCloud("town", std::uint64_t(points)));
    DeviceOptions options;
    options.backend = "cpu";
    const auto device = orExit(createDevice(options));
    constexpr double wanted = 30;
    for (const auto& [width, height] : {std::pair{1280, 720}, {640, 360}}) {
        const auto frames = orbit(*device, *cloud, width, height, count, degrees, method);
        std::printf("%d x %d, %d frames %.2f degrees apart, %d points, method %s\n", width, height, count,
                    degrees, points, frames.front().stats.method.c_str());
        if (isMatch) {
            match(frames);
            continue;
        }
        for (const int quality : {View{}.quality.jpegQuality, 75, 60, 40}) {
            const Cost jpeg = asJpeg(frames, quality);
            const Cost video = asVideo(frames, quantiserFor(quality));
            std::printf(
                "  quality %3d  JPEG %5.2f ms %7.0f bytes %5.2f dB %6.2f Mbit/s   H.264 %5.2f ms %7.0f bytes "
                "%5.2f dB %6.2f Mbit/s, key %.0f bytes: %.2f x smaller\n",
                quality, jpeg.ms, jpeg.bytes, jpeg.psnr, jpeg.rate(wanted), video.ms, video.bytes, video.psnr,
                video.rate(wanted), video.keyBytes, jpeg.bytes / video.bytes);
        }
    }
}
