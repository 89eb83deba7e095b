// How long a live frame takes from its last byte in the pipe to a client's screen. A server in this process reads a
// named pipe and draws on the CPU; a client over a socket watches. Every frame has a grey of its own, so that a picture
// tells which one it shows. Prints a table: median and 95 % of the whole way, and of it, the way into the catalog; then
// how many frames a second are shown of thirty that come.
// Usage: bench_live [frames a row = 30] [scene = statue] [width = 1280] [height = 720]
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>

#include "client/cpp/decode.hpp"
#include "client/cpp/stream.hpp"
#include "files/output_file.hpp"
#include "protocol/view/view_json.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"
#include "server/catalog/live_source.hpp"
#include "server/commands/generate_frames.hpp"
#include "server/server.hpp"
#include "simulator/scene.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace scancast;
using Clock = std::chrono::steady_clock;

namespace {

constexpr int greys = 8;
constexpr int cameraFps = 30;
constexpr std::uint8_t greyOf(int frame) {
    return std::uint8_t(55 + 24 * (frame % greys));
}

struct Settings {
    int frames = 30;
    std::string scene = "statue";
    int width = 1280, height = 720;
};

/// The bytes of one frame.
std::vector<std::byte> frameBytes(const std::vector<PointBatch>& scene, const ScanHeader& header,
                                  int number) {
    std::vector<std::byte> bytes;
    PointStreamWriter writer([&](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    });
    bench::orExit(writer.writeHeader(header));
    for (const PointBatch& chunk : scene) {
        PointBatch points = turned(chunk, {0, 0, 0}, 3.0 * number);
        points.color.assign(points.size(), {greyOf(number), greyOf(number), greyOf(number)});
        bench::orExit(writer.writeChunk(points));
    }
    bench::orExit(writer.finish(0));
    return bytes;
}

std::vector<std::vector<std::byte>> series(const Settings& settings, std::uint64_t points) {
    SceneOptions options;
    options.scene = settings.scene;
    options.points = points;
    const auto source = bench::orExit(simulate(options));
    ScanHeader header;
    header.format = "bench";
    header.points = points;
    header.attributes.color = true;
    std::vector<PointBatch> scene;
    PointBatch batch;
    while (bench::orExit(source->read(batch))) {
        PointBatch& chunk = scene.emplace_back();
        chunk.position = batch.position;
    }
    std::vector<std::vector<std::byte>> frames;
    for (int f = 0; f < greys; ++f) frames.push_back(frameBytes(scene, header, f));
    return frames;
}

void writeAll(int pipe, const std::vector<std::byte>& bytes) {
    if (!PointStreamWriter::toDescriptor(pipe)(bytes))
        bench::orExit(Expected<void>(fail(ErrorCode::Io, "the server reads no more")));
}

/// The grey in the middle of a picture, as the number of a frame of a series; -1 = none.
int numberIn(const client::ReceivedFrame& frame) {
    const auto pixels = bench::orExit(client::decodeJpeg(frame.jpeg));
    const std::size_t middle =
        3 * (std::size_t(pixels.height / 2) * std::size_t(pixels.width) + std::size_t(pixels.width / 2));
    const int grey = pixels.rgb[middle];
    const int number = (grey - greyOf(0) + 12) / 24;
    return grey < greyOf(0) - 11 || number >= greys ? -1 : number;
}

/// Server, pipe and live source of one row.
class Station {
  public:
    Station() {
        const auto fifo = folder_.path() / "frames.fifo";
        if (::mkfifo(fifo.c_str(), 0600) != 0) std::exit(1);
        ServerOptions options;
        options.port = 0;
        BlockCacheOptions memory;
        memory.memoryLimit = std::uint64_t(4) << 30;
        options.cache = BlockCache::create(memory);
        DeviceOptions device;
        device.backend = "cpu";
        server_ = bench::orExit(ScancastServer::create(options, devicePainter(device)));
        server_->scheduler().waitForDevice(std::chrono::seconds(20));
        LiveOptions live;
        live.cache = options.cache;
        live.metrics = &server_->metrics();
        live.onChanged = [this] {
            changed_ = Clock::now().time_since_epoch().count();
            server_->cloudsChanged();
        };
        live.onFailure = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
        source_.emplace(LiveInput{"live", fifo}, server_->catalog(), live);
        pipe_ = ::open(fifo.c_str(), O_WRONLY);
    }
    ~Station() {
        source_->requestStop();
        ::close(pipe_);
    }
    int pipe() const { return pipe_; }
    std::uint16_t port() const { return server_->port(); }
    LiveStatus status() const { return server_->catalog().find(source_->id())->live.value_or(LiveStatus()); }
    void waitForFirst() const {
        while (status().shown == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    /// When the newest cloud came into the catalog.
    Clock::time_point changed() const { return Clock::time_point(Clock::duration(changed_)); }

  private:
    test::TemporaryFolder folder_;
    std::unique_ptr<ScancastServer> server_;
    std::optional<LiveSource> source_;
    std::atomic<Clock::rep> changed_{0};
    int pipe_ = -1;
};

client::Stream watch(const Station& station, const Settings& settings, const std::string& method) {
    messages::Hello hello;
    hello.cloud = "live";
    hello.width = settings.width;
    hello.height = settings.height;
    client::ServerUrl url{"127.0.0.1", station.port(), false};
    auto stream = bench::orExit(client::Stream::open(url, hello));
    View view = bench::orExit(applyJson(View(), stream.welcome().view));
    view.style.method = method;
    view.style.parameters.clear();
    view.style.color = ColorSource::Rgb;
    view.style.shading = Shading::Unlit;
    view.style.exposure = 0;
    view.style.light.occlusion = 0;
    bench::orExit(stream.sendView(1, view));
    return stream;
}

/// Takes pictures until one shows that frame; false when none does for 20 seconds.
bool see(client::Stream& stream, int number) {
    const auto end = Clock::now() + std::chrono::seconds(20);
    while (Clock::now() < end) {
        auto event = bench::orExit(stream.receiveFor(std::chrono::milliseconds(100)));
        if (!event || !std::holds_alternative<client::ReceivedFrame>(*event)) continue;
        const auto& frame = std::get<client::ReceivedFrame>(*event);
        const auto arrived = numberIn(frame);
        bench::orExit(stream.ack(frame.header));
        if (arrived == number) return true;
    }
    return false;
}

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

void measure(const Settings& settings, std::uint64_t points,
             const std::vector<std::vector<std::byte>>& frames, const std::string& method) {
    Station station;
    writeAll(station.pipe(), frames[0]);
    station.waitForFirst();
    auto stream = watch(station, settings, method);
    std::vector<double> whole, toCloud;
    for (int n = 1; n <= settings.frames; ++n) {
        // The still of the last one is drawn by then, and this one meets the server at no special time.
        const auto pause = Clock::now() + std::chrono::milliseconds(400 + 37 * n % 60);
        while (Clock::now() < pause) {
            auto event = bench::orExit(stream.receiveFor(std::chrono::milliseconds(20)));
            if (event && std::holds_alternative<client::ReceivedFrame>(*event))
                bench::orExit(stream.ack(std::get<client::ReceivedFrame>(*event).header));
        }
        writeAll(station.pipe(), frames[std::size_t(n % greys)]);
        const auto sent = Clock::now();
        if (!see(stream, n % greys)) {
            std::printf("frame %d was never seen\n", n);
            continue;
        }
        const auto seen = Clock::now();
        whole.push_back(std::chrono::duration<double, std::milli>(seen - sent).count());
        toCloud.push_back(std::chrono::duration<double, std::milli>(station.changed() - sent).count());
    }
    const LiveStatus before = station.status();
    const auto begun = Clock::now();
    std::jthread drain([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            auto event = bench::orExit(stream.receiveFor(std::chrono::milliseconds(20)));
            if (event && std::holds_alternative<client::ReceivedFrame>(*event))
                bench::orExit(stream.ack(std::get<client::ReceivedFrame>(*event).header));
        }
    });
    std::uint64_t written = 0;
    for (; Clock::now() - begun < std::chrono::seconds(4); ++written) {
        std::this_thread::sleep_until(begun + written * std::chrono::microseconds(1'000'000 / cameraFps));
        writeAll(station.pipe(), frames[std::size_t(written % greys)]);
    }
    const LiveStatus after = station.status();
    const double seconds = std::chrono::duration<double>(Clock::now() - begun).count();
    drain.request_stop();
    drain.join();
    std::printf("| %s | %s | %.0f | %.0f | %.0f | %.0f | %.1f of %.1f |\n",
                fmt::format("{}k", points / 1000).c_str(), method.c_str(), bench::median(whole),
                percentile(whole, 0.95), bench::median(toCloud), percentile(toCloud, 0.95),
                double(after.shown - before.shown) / seconds, double(written) / seconds);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);
    Settings settings;
    if (argc > 1) settings.frames = std::atoi(argv[1]);
    if (argc > 2) settings.scene = argv[2];
    if (argc > 3) settings.width = std::atoi(argv[3]);
    if (argc > 4) settings.height = std::atoi(argv[4]);
    std::printf("%s, %d x %d, %u cores, %d frames a row; ms from a frame's last byte\n\n",
                settings.scene.c_str(), settings.width, settings.height, std::thread::hardware_concurrency(),
                settings.frames);
    std::printf(
        "| points | method | to the picture: median | 95 %% | to the cloud: median | 95 %% | shown of sent, "
        "1/s |\n");
    std::printf("|---|---|---|---|---|---|---|\n");
    for (const std::uint64_t points : {100'000ULL, 300'000ULL, 1'000'000ULL}) {
        const auto frames = series(settings, points);
        for (const char* method : {"pyramid", "paraboloid", "voronoi"})
            measure(settings, points, frames, method);
    }
}
