#include "server/catalog/live_source.hpp"

#include <fmt/format.h>

#include <tuple>
#include <utility>

#include "renderer/cloud/import/stream/frame_reader.hpp"
#include "renderer/look/decide_look.hpp"
#include "server/catalog/counted_cloud.hpp"
#include "server/catalog/live_bytes.hpp"

namespace scancast {
namespace {

// A point of a frame as it was read, and in a cloud with its averages.
constexpr std::uint64_t bytesPerReadPoint = 42, bytesPerShownPoint = 24;
// One frame is read, one waits, one is built; pictures hold on to a cloud or two of before.
constexpr std::uint64_t framesAtOnce = 3, cloudsAtOnce = 3;

std::uint64_t bytesToBuild(const PointFrame& frame) {
    return frame.points.size() * (bytesToBuildFramePoint + bytesPerReadPoint);
}

}  // namespace

std::uint64_t mostFramePoints(std::uint64_t memoryLimit) {
    return memoryLimit / 2 /
           (framesAtOnce * bytesPerReadPoint + bytesToBuildFramePoint + cloudsAtOnce * bytesPerShownPoint);
}

Expected<LiveInput> parseLiveInput(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        return fail(
            ErrorCode::InvalidArgument,
            "--live: '" + text +
                "' is not NAME=PATH; for example --live depth=- for frames on standard input, or --live "
                "depth=/run/depth.fifo for those of a named pipe",
            "live");
    return LiveInput{text.substr(0, equals), text.substr(equals + 1)};
}

LiveSource::LiveSource(LiveInput input, Catalog& catalog, LiveOptions options)
    : input_(std::move(input)),
      catalog_(catalog),
      options_(std::move(options)),
      id_(catalog_.addLive(input_.name)),
      failures_([this](const std::string& line) {
          if (options_.onFailure) options_.onFailure(id_ + ": " + line);
      }),
      nextNote_(Clock::now()) {
    catalog_.setProgress(id_, "waiting for frames", 0, 0);
    reader_ = std::thread([this] {
        if (const auto read = contained("Reading a live source", [this] { readAll(); }); !read)
            ended(LiveStatus::State::Broken, "the server failed to read it");
        const Monitor::Lock lock(monitor_);
        allRead_ = true;
    });
    builder_ = std::thread([this] { buildAll(); });
}

LiveSource::~LiveSource() {
    requestStop();
    reader_.join();
    builder_.join();
}

void LiveSource::requestStop() {
    const Monitor::Lock lock(monitor_);
    stop_.request_stop();
}

bool LiveSource::finished() const {
    const Monitor::Look look(monitor_);
    return finished_;
}

bool LiveSource::failed() const {
    const Monitor::Look look(monitor_);
    return finished_ && status_.shown == 0;
}

// ---- the reading thread

void LiveSource::readAll() {
    auto bytes = LiveBytes::open(input_.path, stop_.get_token());
    if (!bytes) return ended(LiveStatus::State::Broken, bytes.error().message);
    readFrom(std::move(*bytes));
}

// A named pipe outlives its writers. The next one finds it open: a writer between two readers would be told that
// nobody reads.
void LiveSource::readFrom(std::unique_ptr<LiveBytes> bytes) {
    const bool reopens = bytes->reopens();
    auto frames =
        std::make_unique<FrameReader>(std::move(bytes), mostFramePoints(options_.cache->stats().limit));
    readFrames(*frames);
    while (reopens && !stop_.stop_requested()) {
        // Of a stream that broke: its writer would go on where the next one begins. After one that ended, whatever comes
        // is the next writer's already.
        if (!frames->mayGoOn()) frames->discardRest();
        auto next = LiveBytes::open(input_.path, stop_.get_token());
        if (!next) return ended(LiveStatus::State::Broken, next.error().message);
        frames =
            std::make_unique<FrameReader>(std::move(*next), mostFramePoints(options_.cache->stats().limit));
        readFrames(*frames);
    }
}

void LiveSource::readFrames(FrameReader& frames) {
    while (!stop_.stop_requested()) {
        auto frame = frames.next();
        if (frame && *frame) {
            arrived(std::move(**frame));
        } else if (frame) {
            return ended(LiveStatus::State::Ended, {});
        } else if (frame.error().code != ErrorCode::Cancelled) {
            frameFailed(frame.error());
            if (frames.mayGoOn()) continue;
            return ended(LiveStatus::State::Broken, frame.error().message);
        }
    }
}

void LiveSource::arrived(PointFrame frame) {
    bool replaced = false;
    {
        const Monitor::Lock lock(monitor_);
        replaced = waiting_.has_value();
        if (replaced) ++status_.skipped;
        status_.state = LiveStatus::State::Running;
        waiting_ = Arrived{std::move(frame), Clock::now()};
    }
    if (!replaced) return;
    count(LiveOutcome::Skipped);
    tellSkipped(false);
}

void LiveSource::tellSkipped(bool atEnd) {
    std::uint64_t skipped = 0;
    {
        const Monitor::Look look(monitor_);
        skipped = status_.skipped;
    }
    if (skipped == skippedTold_ || (!atEnd && Clock::now() < nextNote_)) return;
    nextNote_ = Clock::now() + options_.noteInterval;
    if (options_.onNote)
        options_.onNote(
            fmt::format("{}: frames skipped, because newer ones came while they waited: {}, {} in all", id_,
                        skipped - skippedTold_, skipped));
    skippedTold_ = skipped;
}

void LiveSource::ended(LiveStatus::State state, std::string error) {
    tellSkipped(true);
    LiveStatus now;
    {
        const Monitor::Lock lock(monitor_);
        status_.state = state;
        status_.error = std::move(error);
        now = status_;
    }
    publish();
    if (state == LiveStatus::State::Broken && options_.onFailure)
        options_.onFailure(id_ + ": nothing more is read of it: " + now.error);
    if (state == LiveStatus::State::Ended && options_.onNote)
        options_.onNote(fmt::format("{}: its frames have ended ({} skipped, {} failed); the last one stays",
                                    id_, now.skipped, now.failed));
}

void LiveSource::frameFailed(const Error& error) {
    {
        const Monitor::Lock lock(monitor_);
        ++status_.failed;
        status_.error = error.message;
    }
    count(LiveOutcome::Failed);
    failures_.report({error.code, "a frame is left out: " + error.message, {}});
    publish();
}

// ---- the building thread

void LiveSource::buildAll() {
    while (buildNext()) {
    }
    bool nothingShown = false;
    std::string error;
    {
        const Monitor::Lock lock(monitor_);
        finished_ = true;
        nothingShown = status_.shown == 0 && !stop_.stop_requested();
        error = status_.error.empty() ? "its frames ended before there was one" : status_.error;
    }
    if (nothingShown) catalog_.setFailed(id_, error);
}

bool LiveSource::buildNext() {
    std::optional<Arrived> next;
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [this] { return waiting_ || allRead_ || stop_.stop_requested(); });
        if (stop_.stop_requested() || !waiting_) return false;
        next = std::exchange(waiting_, std::nullopt);
    }
    if (const auto built = contained("Building a live frame", [&] { build(*next); }); !built)
        frameFailed(built.error());
    return true;
}

void LiveSource::build(const Arrived& arrived) {
    const auto building = options_.cache->reserve(bytesToBuild(arrived.frame));
    FrameOptions options;
    options.title = input_.name;
    options.threads = options_.threads;
    options.surfels = options_.surfels;
    options.basis = basis_ ? &*basis_ : nullptr;
    auto cloud = buildFrameCloud(arrived.frame, options);
    if (!cloud) return frameFailed(cloud.error());
    if (!basis_) {
        *cloud = withLook(std::move(*cloud));
        basis_ = basisOf(**cloud);
    }
    shown(counted(std::move(*cloud), options_.cache), arrived.at);
}

void LiveSource::shown(std::shared_ptr<const Cloud> cloud, Clock::time_point arrivedAt) {
    {
        const Monitor::Lock lock(monitor_);
        ++status_.shown;
        if (status_.state != LiveStatus::State::Broken) status_.error.clear();
    }
    publish(std::move(cloud));
    if (options_.metrics)
        options_.metrics->liveFrameShown(std::chrono::duration<double>(Clock::now() - arrivedAt).count());
}

// ---- both

void LiveSource::count(LiveOutcome outcome) {
    if (options_.metrics) options_.metrics->liveFrame(outcome);
}

void LiveSource::publish(std::shared_ptr<const Cloud> cloud) {
    {
        const std::lock_guard inTurn(publishing_);
        LiveStatus now;
        {
            const Monitor::Look look(monitor_);
            now = status_;
        }
        catalog_.setLive(id_, std::move(now), std::move(cloud));
    }
    if (options_.onChanged) options_.onChanged();
}

}  // namespace scancast
