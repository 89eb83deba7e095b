#include "server/base/metrics.hpp"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <mutex>
#include <optional>

#include "files/machine.hpp"

namespace scancast {
namespace {

using Buckets = prometheus::Histogram::BucketBoundaries;

const Buckets renderBuckets{0.001, 0.002, 0.005, 0.01, 0.02, 0.033, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10};
const Buckets encodeBuckets{0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5};
const Buckets byteBuckets{4096, 16384, 32768, 65536, 131072, 262144, 524288, 1048576, 4194304};

const char* name(DropReason reason) {
    switch (reason) {
        case DropReason::Overwritten:
            return "overwritten";
        case DropReason::Abandoned:
            return "abandoned";
        case DropReason::Deadline:
            return "deadline";
        case DropReason::Failed:
            return "failed";
        case DropReason::Gone:
            return "gone";
        case DropReason::Lacking:
            return "lacking";
    }
    return "unknown";
}

const char* name(CostRefusal why) {
    switch (why) {
        case CostRefusal::Picture:
            return "picture";
        case CostRefusal::Client:
            return "client";
        case CostRefusal::Total:
            return "total";
    }
    return "unknown";
}

const char* name(LoginFailure why) {
    switch (why) {
        case LoginFailure::Malformed:
            return "malformed";
        case LoginFailure::Unknown:
            return "unknown";
        case LoginFailure::Expired:
            return "expired";
    }
    return "unknown";
}

const char* name(ConnectionRefusal why) {
    switch (why) {
        case ConnectionRefusal::Full:
            return "full";
        case ConnectionRefusal::Address:
            return "address";
        case ConnectionRefusal::ShuttingDown:
            return "shutdown";
    }
    return "unknown";
}

const char* name(LiveOutcome outcome) {
    switch (outcome) {
        case LiveOutcome::Shown:
            return "shown";
        case LiveOutcome::Skipped:
            return "skipped";
        case LiveOutcome::Failed:
            return "failed";
    }
    return "unknown";
}

const char* name(LogLine outcome) {
    switch (outcome) {
        case LogLine::Written:
            return "written";
        case LogLine::Repeated:
            return "repeated";
        case LogLine::Lost:
            return "lost";
    }
    return "unknown";
}

const char* outcomeOfReload(bool sound) {
    if (sound) return "applied";
    return "refused";
}

double secondsOf(std::chrono::system_clock::time_point time) {
    return double(std::chrono::duration_cast<std::chrono::seconds>(time.time_since_epoch()).count());
}

}  // namespace

/// Only of a server that has ranks: who watches others would take 0 for an alarm.
struct RanksFamilies {
    explicit RanksFamilies(prometheus::Registry& registry)
        : up(prometheus::BuildGauge()
                 .Name("scancast_ranks_up")
                 .Help("1 while ranks draw; 0 while the server draws without them")
                 .Register(registry)
                 .Add({})),
          restarts(prometheus::BuildCounter()
                       .Name("scancast_ranks_restarts_total")
                       .Help("Starts of the ranks after the first one")
                       .Register(registry)
                       .Add({})) {}

    prometheus::Gauge& up;
    prometheus::Counter& restarts;
};

struct Metrics::Families {
    std::mutex residency;
    prometheus::Registry registry;
    std::optional<RanksFamilies> ranks;
    prometheus::Family<prometheus::Histogram>& render =
        prometheus::BuildHistogram()
            .Name("scancast_frame_render_seconds")
            .Help("Time from view to frame in memory, encoding left out")
            .Register(registry);
    prometheus::Histogram& encode = prometheus::BuildHistogram()
                                        .Name("scancast_frame_encode_seconds")
                                        .Help("Time to encode one picture")
                                        .Register(registry)
                                        .Add({}, encodeBuckets);
    prometheus::Histogram& bytes = prometheus::BuildHistogram()
                                       .Name("scancast_frame_bytes")
                                       .Help("Size of one encoded picture")
                                       .Register(registry)
                                       .Add({}, byteBuckets);
    prometheus::Counter& sent = prometheus::BuildCounter()
                                    .Name("scancast_frames_sent_total")
                                    .Help("Frames written to streams")
                                    .Register(registry)
                                    .Add({});
    prometheus::Family<prometheus::Counter>& dropped =
        prometheus::BuildCounter()
            .Name("scancast_frames_dropped_total")
            .Help("Pictures that were asked for and never shown")
            .Register(registry);
    prometheus::Counter& price =
        prometheus::BuildCounter()
            .Name("scancast_price_seconds_total")
            .Help("What snapshots that were taken on are priced at, in seconds of a core")
            .Register(registry)
            .Add({});
    prometheus::Family<prometheus::Counter>& priceEnded =
        prometheus::BuildCounter()
            .Name("scancast_price_ended_seconds_total")
            .Help("The same of those that have been drawn, or have ended otherwise, by what became of them")
            .Register(registry);
    prometheus::Family<prometheus::Histogram>& waits =
        prometheus::BuildHistogram()
            .Name("scancast_wait_seconds")
            .Help("Time from when a picture is asked for to its first turn on the device")
            .Register(registry);
    prometheus::Family<prometheus::Gauge>& queues =
        prometheus::BuildGauge()
            .Name("scancast_queue_length")
            .Help(
                "Pictures that wait: views and stills of streams, and snapshots, for the device; for "
                "blocks; for encoders")
            .Register(registry);
    prometheus::Family<prometheus::Counter>& refused =
        prometheus::BuildCounter()
            .Name("scancast_pictures_refused_total")
            .Help("Pictures that were refused for their cost, by whose limit it was")
            .Register(registry);
    prometheus::Histogram& viewToFrame =
        prometheus::BuildHistogram()
            .Name("scancast_view_to_frame_seconds")
            .Help("Time from the arrival of a view to the writing of its first frame")
            .Register(registry)
            .Add({}, renderBuckets);
    prometheus::Gauge& sessions = prometheus::BuildGauge()
                                      .Name("scancast_sessions")
                                      .Help("Open stream sessions")
                                      .Register(registry)
                                      .Add({});
    prometheus::Gauge& draining =
        prometheus::BuildGauge()
            .Name("scancast_draining")
            .Help("1 when the server takes no new streams, because it is about to end")
            .Register(registry)
            .Add({});
    prometheus::Gauge& saturation =
        prometheus::BuildGauge()
            .Name("scancast_render_saturation")
            .Help("Share of the last 15 seconds in which the render thread was at work, 0 to 1")
            .Register(registry)
            .Add({});
    prometheus::Gauge& connections =
        prometheus::BuildGauge()
            .Name("scancast_connections")
            .Help("Open connections, those of sessions included and those of --admin-listen not")
            .Register(registry)
            .Add({});
    prometheus::Family<prometheus::Counter>& turnedAway =
        prometheus::BuildCounter()
            .Name("scancast_connections_refused_total")
            .Help("Connections, and requests through proxies, that there was no place for, by reason")
            .Register(registry);
    prometheus::Family<prometheus::Counter>& failedLogins =
        prometheus::BuildCounter()
            .Name("scancast_failed_logins_total")
            .Help("Requests with a token that let nobody in, by reason")
            .Register(registry);
    prometheus::Counter& displaced = prometheus::BuildCounter()
                                         .Name("scancast_connections_displaced_total")
                                         .Help("Idle connections that were closed to make room")
                                         .Register(registry)
                                         .Add({});
    prometheus::Gauge& points = prometheus::BuildGauge()
                                    .Name("scancast_points_resident")
                                    .Help("Scan points held in memory")
                                    .Register(registry)
                                    .Add({});
    prometheus::Gauge& awaited = prometheus::BuildGauge()
                                     .Name("scancast_pictures_awaited")
                                     .Help("Requests that wait for a snapshot or a pick")
                                     .Register(registry)
                                     .Add({});
    prometheus::Counter& incomplete = prometheus::BuildCounter()
                                          .Name("scancast_frames_incomplete_total")
                                          .Help("Frames rendered with ancestors for blocks not in memory")
                                          .Register(registry)
                                          .Add({});
    prometheus::Counter& framesAway =
        prometheus::BuildCounter()
            .Name("scancast_frames_away_total")
            .Help("Frames sent coarser than they would be, because a part of the server is out of reach")
            .Register(registry)
            .Add({});
    prometheus::Counter& framesShared =
        prometheus::BuildCounter()
            .Name("scancast_frames_shared_total")
            .Help("Frames sent to streams that were drawn and encoded for the stream that they follow")
            .Register(registry)
            .Add({});
    prometheus::Gauge& residentBytes = prometheus::BuildGauge()
                                           .Name("scancast_residency_bytes")
                                           .Help("Memory that clouds take, blocks held by pictures included")
                                           .Register(registry)
                                           .Add({});
    prometheus::Gauge& residentLimit = prometheus::BuildGauge()
                                           .Name("scancast_residency_limit_bytes")
                                           .Help("The memory limit")
                                           .Register(registry)
                                           .Add({});
    prometheus::Gauge& deviceBytes = prometheus::BuildGauge()
                                         .Name("scancast_device_memory_bytes")
                                         .Help("Memory of the GPU that holds samples")
                                         .Register(registry)
                                         .Add({});
    prometheus::Family<prometheus::Gauge>& memory =
        prometheus::BuildGauge()
            .Name("scancast_transient_bytes")
            .Help("Memory that pictures and clients take, clouds not counted, by what it is for")
            .Register(registry);
    prometheus::Gauge& memoryLimit = prometheus::BuildGauge()
                                         .Name("scancast_transient_limit_bytes")
                                         .Help("What pictures and clients may take together")
                                         .Register(registry)
                                         .Add({});
    prometheus::Gauge& resident = prometheus::BuildGauge()
                                      .Name("scancast_process_resident_bytes")
                                      .Help("Memory of the whole process, as the system counts it")
                                      .Register(registry)
                                      .Add({});
    prometheus::Counter& slowReaders = prometheus::BuildCounter()
                                           .Name("scancast_slow_readers_total")
                                           .Help("Connections ended because what was sent was not read")
                                           .Register(registry)
                                           .Add({});
    prometheus::Gauge& keptBytes = prometheus::BuildGauge()
                                       .Name("scancast_kept_clouds_bytes")
                                       .Help("Cloud files and programs in --cache-dir")
                                       .Register(registry)
                                       .Add({});
    prometheus::Gauge& keptLimit = prometheus::BuildGauge()
                                       .Name("scancast_kept_clouds_limit_bytes")
                                       .Help("What these may take (--cache-size)")
                                       .Register(registry)
                                       .Add({});
    prometheus::Counter& keptEvicted = prometheus::BuildCounter()
                                           .Name("scancast_kept_clouds_evicted_total")
                                           .Help("Cloud files removed from --cache-dir to make room")
                                           .Register(registry)
                                           .Add({});
    prometheus::Counter& remoteRequests = prometheus::BuildCounter()
                                              .Name("scancast_remote_requests_total")
                                              .Help("Requests to object storage, tries included")
                                              .Register(registry)
                                              .Add({});
    prometheus::Counter& remoteRetries = prometheus::BuildCounter()
                                             .Name("scancast_remote_retries_total")
                                             .Help("Of these, those that were made again")
                                             .Register(registry)
                                             .Add({});
    prometheus::Counter& remoteBytes = prometheus::BuildCounter()
                                           .Name("scancast_remote_bytes_total")
                                           .Help("Bytes of clouds fetched from object storage")
                                           .Register(registry)
                                           .Add({});
    prometheus::Family<prometheus::Counter>& remotePieces =
        prometheus::BuildCounter()
            .Name("scancast_remote_pieces_total")
            .Help("Pieces of clouds in object storage that were wanted, by where they were found")
            .Register(registry);
    prometheus::Counter& piecesInMemory = remotePieces.Add({{"found", "memory"}});
    prometheus::Counter& piecesOnDisk = remotePieces.Add({{"found", "disk"}});
    prometheus::Counter& piecesFetched = remotePieces.Add({{"found", "nowhere"}});
    prometheus::Counter& brokenPieces = prometheus::BuildCounter()
                                            .Name("scancast_remote_broken_pieces_total")
                                            .Help("Pieces in --cache-dir that were not what was saved")
                                            .Register(registry)
                                            .Add({});
    prometheus::Gauge& piecesBytes = prometheus::BuildGauge()
                                         .Name("scancast_remote_cache_bytes")
                                         .Help("Pieces of clouds in object storage in --cache-dir")
                                         .Register(registry)
                                         .Add({});
    prometheus::Gauge& piecesLimit = prometheus::BuildGauge()
                                         .Name("scancast_remote_cache_limit_bytes")
                                         .Help("What those may take")
                                         .Register(registry)
                                         .Add({});
    prometheus::Gauge& remoteAway = prometheus::BuildGauge()
                                        .Name("scancast_remote_clouds_away")
                                        .Help("Clouds in object storage that cannot be fetched now")
                                        .Register(registry)
                                        .Add({});
    prometheus::Counter& blocksLoaded = prometheus::BuildCounter()
                                            .Name("scancast_blocks_loaded_total")
                                            .Help("Blocks of cloud files read into memory")
                                            .Register(registry)
                                            .Add({});
    prometheus::Counter& blocksEvicted = prometheus::BuildCounter()
                                             .Name("scancast_blocks_evicted_total")
                                             .Help("Blocks of cloud files given up for others")
                                             .Register(registry)
                                             .Add({});
    prometheus::Counter& blocksDamaged = prometheus::BuildCounter()
                                             .Name("scancast_block_load_errors_total")
                                             .Help("Blocks of cloud files that could not be read")
                                             .Register(registry)
                                             .Add({});
    prometheus::Family<prometheus::Counter>& liveFrames =
        prometheus::BuildCounter()
            .Name("scancast_live_frames_total")
            .Help("Frames of live sources, by what became of them")
            .Register(registry);
    prometheus::Histogram& frameToCloud =
        prometheus::BuildHistogram()
            .Name("scancast_live_frame_seconds")
            .Help("Time from a live frame's last byte to the cloud that is shown")
            .Register(registry)
            .Add({}, renderBuckets);
    std::mutex device;
    prometheus::Family<prometheus::Gauge>& devices = prometheus::BuildGauge()
                                                         .Name("scancast_device_info")
                                                         .Help("Always 1; what draws is its label")
                                                         .Register(registry);
    prometheus::Gauge* deviceInUse = nullptr;
    prometheus::Counter& devicesLost = prometheus::BuildCounter()
                                           .Name("scancast_devices_lost_total")
                                           .Help("Rendering devices that were there and are gone")
                                           .Register(registry)
                                           .Add({});
    prometheus::Family<prometheus::Counter>& requests = prometheus::BuildCounter()
                                                            .Name("scancast_http_requests_total")
                                                            .Help("HTTP requests answered")
                                                            .Register(registry);
    prometheus::Family<prometheus::Gauge>& memoryParts =
        prometheus::BuildGauge()
            .Name("scancast_transient_part_bytes")
            .Help("What each use that others could fill may take of scancast_transient_limit_bytes")
            .Register(registry);
    prometheus::Gauge& heap =
        prometheus::BuildGauge()
            .Name("scancast_process_heap_bytes")
            .Help("Memory that the process has asked its allocator for and not given back")
            .Register(registry)
            .Add({});
    prometheus::Gauge& files = prometheus::BuildGauge()
                                   .Name("scancast_process_open_files")
                                   .Help("Descriptors that the process has open")
                                   .Register(registry)
                                   .Add({});
    prometheus::Gauge& threads = prometheus::BuildGauge()
                                     .Name("scancast_process_threads")
                                     .Help("Threads of the process")
                                     .Register(registry)
                                     .Add({});
    prometheus::Gauge& requestsNow =
        prometheus::BuildGauge()
            .Name("scancast_http_requests_in_flight")
            .Help("HTTP requests that have been read and not been answered to the end; no streams")
            .Register(registry)
            .Add({});
    prometheus::Family<prometheus::Counter>& logLines =
        prometheus::BuildCounter()
            .Name("scancast_request_log_lines_total")
            .Help("Lines of the request log, by what became of them")
            .Register(registry);
    prometheus::Family<prometheus::Gauge>& certificateExpiry =
        prometheus::BuildGauge()
            .Name("scancast_tls_certificate_expiry_timestamp_seconds")
            .Help("When the first certificate of the chain that is shown expires; none without TLS")
            .Register(registry);
    prometheus::Family<prometheus::Counter>& reloads =
        prometheus::BuildCounter()
            .Name("scancast_reloads_total")
            .Help("SIGHUPs, by whether all that was read anew was sound (applied) or not (refused)")
            .Register(registry);
    prometheus::Gauge& lastReload = prometheus::BuildGauge()
                                        .Name("scancast_last_good_reload_timestamp_seconds")
                                        .Help("When all was read last and was sound; at first, the start")
                                        .Register(registry)
                                        .Add({});
};

Metrics::Metrics(std::string_view version) : families_(std::make_unique<Families>()) {
    prometheus::BuildGauge()
        .Name("scancast_build_info")
        .Help("Always 1; the version is its label")
        .Register(families_->registry)
        .Add({{"version", std::string(version)}})
        .Set(1);
    // Counters that exist from the start read as 0 instead of "no data".
    for (DropReason reason : {DropReason::Overwritten, DropReason::Abandoned, DropReason::Deadline,
                              DropReason::Failed, DropReason::Gone, DropReason::Lacking}) {
        families_->dropped.Add({{"reason", name(reason)}});
    }
    families_->priceEnded.Add({{"outcome", "drawn"}});
    for (ConnectionRefusal why :
         {ConnectionRefusal::Full, ConnectionRefusal::Address, ConnectionRefusal::ShuttingDown})
        families_->turnedAway.Add({{"reason", name(why)}});
    for (const bool sound : {true, false}) families_->reloads.Add({{"outcome", outcomeOfReload(sound)}});
    families_->lastReload.Set(secondsOf(std::chrono::system_clock::now()));
    for (LoginFailure why : {LoginFailure::Malformed, LoginFailure::Unknown, LoginFailure::Expired})
        families_->failedLogins.Add({{"reason", name(why)}});
    for (LiveOutcome outcome : {LiveOutcome::Shown, LiveOutcome::Skipped, LiveOutcome::Failed})
        families_->liveFrames.Add({{"outcome", name(outcome)}});
    for (LogLine outcome : {LogLine::Written, LogLine::Repeated, LogLine::Lost})
        families_->logLines.Add({{"outcome", name(outcome)}});
}

Metrics::~Metrics() = default;

void Metrics::frameRendered(std::string_view method, double seconds, bool complete) {
    if (!complete) families_->incomplete.Increment();
    families_->render.Add({{"method", std::string(method)}}, renderBuckets).Observe(seconds);
}

void Metrics::frameEncoded(double seconds, std::uint64_t bytes) {
    families_->encode.Observe(seconds);
    families_->bytes.Observe(double(bytes));
}

void Metrics::frameShared() {
    families_->framesShared.Increment();
}

void Metrics::frameSent(double viewToFrameSeconds, bool away) {
    if (away) families_->framesAway.Increment();
    families_->sent.Increment();
    families_->viewToFrame.Observe(viewToFrameSeconds);
}

void Metrics::setDevice(std::string_view name, std::string_view renderer) {
    const std::lock_guard lock(families_->device);
    if (families_->deviceInUse) families_->devices.Remove(families_->deviceInUse);
    families_->deviceInUse = nullptr;
    if (name.empty()) return;
    families_->deviceInUse =
        &families_->devices.Add({{"name", std::string(name)}, {"renderer", std::string(renderer)}});
    families_->deviceInUse->Set(1);
}

void Metrics::deviceLost() {
    families_->devicesLost.Increment();
}

void Metrics::frameDropped(DropReason reason) {
    families_->dropped.Add({{"reason", name(reason)}}).Increment();
}

void Metrics::pictureAdmitted(double coreSeconds) {
    families_->price.Increment(coreSeconds);
}

void Metrics::priceEnded(std::optional<DropReason> why, double coreSeconds) {
    families_->priceEnded.Add({{"outcome", why ? name(*why) : "drawn"}}).Increment(coreSeconds);
}

void Metrics::pictureWaited(std::string_view kind, double seconds) {
    families_->waits.Add({{"kind", std::string(kind)}}, renderBuckets).Observe(seconds);
}

void Metrics::setQueues(const QueueLengths& lengths) {
    const auto set = [this](const char* queue, std::size_t length) {
        families_->queues.Add({{"queue", queue}}).Set(double(length));
    };
    set("views", lengths.views);
    set("stills", lengths.stills);
    set("snapshots", lengths.snapshots);
    set("blocks", lengths.blocks);
    set("encodings", lengths.encodings);
}

void Metrics::setRenderSaturation(double share) {
    families_->saturation.Set(share);
}

void Metrics::setDraining() {
    families_->draining.Set(1);
}

void Metrics::pictureRefused(CostRefusal why) {
    families_->refused.Add({{"by", name(why)}}).Increment();
}

void Metrics::sessionOpened() {
    families_->sessions.Increment();
}
void Metrics::sessionClosed() {
    families_->sessions.Decrement();
}
void Metrics::setConnections(std::size_t now) {
    families_->connections.Set(double(now));
}

void Metrics::connectionRefused(ConnectionRefusal why) {
    families_->turnedAway.Add({{"reason", name(why)}}).Increment();
}

void Metrics::loginFailed(LoginFailure why) {
    families_->failedLogins.Add({{"reason", name(why)}}).Increment();
}

void Metrics::connectionDisplaced() {
    families_->displaced.Increment();
}

void Metrics::setPointsResident(std::uint64_t points) {
    families_->points.Set(double(points));
}

void Metrics::setPicturesAwaited(std::size_t requests) {
    families_->awaited.Set(double(requests));
}

void Metrics::setDeviceMemory(std::uint64_t bytes) {
    families_->deviceBytes.Set(double(bytes));
}

void Metrics::setResidency(const BlockCacheStats& stats) {
    const std::lock_guard lock(families_->residency);
    families_->residentBytes.Set(double(stats.bytes));
    families_->residentLimit.Set(double(stats.limit));
    const auto raise = [](prometheus::Counter& counter, std::uint64_t total) {
        const double more = double(total) - counter.Value();
        if (more > 0) counter.Increment(more);
    };
    raise(families_->blocksLoaded, stats.blocksLoaded);
    raise(families_->blocksEvicted, stats.blocksEvicted);
    raise(families_->blocksDamaged, stats.blocksDamaged);
}

void Metrics::setRemote(const RemoteStats& stats) {
    const std::lock_guard lock(families_->residency);
    const auto raise = [](prometheus::Counter& counter, std::uint64_t total) {
        const double more = double(total) - counter.Value();
        if (more > 0) counter.Increment(more);
    };
    raise(families_->remoteRequests, stats.transfers.requests);
    raise(families_->remoteRetries, stats.transfers.retries);
    raise(families_->remoteBytes, stats.transfers.bytes);
    raise(families_->piecesInMemory, stats.memoryHits);
    raise(families_->piecesOnDisk, stats.diskHits);
    raise(families_->piecesFetched, stats.misses);
    raise(families_->brokenPieces, stats.brokenPieces);
    families_->piecesBytes.Set(double(stats.folderBytes));
    families_->piecesLimit.Set(double(stats.folderLimit));
    families_->remoteAway.Set(double(stats.away));
}

void Metrics::setRanks(const RanksStats& stats) {
    const std::lock_guard lock(families_->residency);
    if (!families_->ranks) families_->ranks.emplace(families_->registry);
    families_->ranks->up.Set(stats.up ? 1 : 0);
    const double more = double(stats.restarts) - families_->ranks->restarts.Value();
    if (more > 0) families_->ranks->restarts.Increment(more);
}

void Metrics::setKeptClouds(std::uint64_t bytes, std::uint64_t limit, std::uint64_t evicted) {
    const std::lock_guard lock(families_->residency);
    families_->keptBytes.Set(double(bytes));
    families_->keptLimit.Set(double(limit));
    const double more = double(evicted) - families_->keptEvicted.Value();
    if (more > 0) families_->keptEvicted.Increment(more);
}

void Metrics::setMemory(const TransientMemory& memory) {
    for (std::size_t use = 0; use < memoryUses; ++use)
        families_->memory.Add({{"use", std::string(scancast::name(MemoryUse(use)))}})
            .Set(double(memory.bytes(MemoryUse(use))));
    families_->memoryLimit.Set(double(memory.limit()));
    const auto part = [this](MemoryUse use, std::uint64_t bytes) {
        families_->memoryParts.Add({{"use", std::string(scancast::name(use))}}).Set(double(bytes));
    };
    part(MemoryUse::Frames, memory.forFrames());
    part(MemoryUse::Answers, memory.forAnswers());
    part(MemoryUse::Streams, memory.forStreams());
    families_->resident.Set(double(residentMemory()));
    families_->heap.Set(double(heapMemory()));
    families_->files.Set(double(openFileCount()));
    families_->threads.Set(double(threadCount()));
}

void Metrics::slowReaderEnded() {
    families_->slowReaders.Increment();
}

void Metrics::liveFrame(LiveOutcome outcome) {
    families_->liveFrames.Add({{"outcome", name(outcome)}}).Increment();
}

void Metrics::liveFrameShown(double seconds) {
    liveFrame(LiveOutcome::Shown);
    families_->frameToCloud.Observe(seconds);
}

void Metrics::httpRequest(std::string_view route, int code) {
    families_->requests.Add({{"route", std::string(route)}, {"code", std::to_string(code)}}).Increment();
}

void Metrics::requestBegan() noexcept {
    families_->requestsNow.Increment();
}

void Metrics::requestEnded() noexcept {
    families_->requestsNow.Decrement();
}

void Metrics::logLine(LogLine outcome) {
    families_->logLines.Add({{"outcome", name(outcome)}}).Increment();
}

void Metrics::setCertificateExpiry(std::chrono::system_clock::time_point expires) {
    families_->certificateExpiry.Add({}).Set(secondsOf(expires));
}

void Metrics::reloaded(bool sound, std::chrono::system_clock::time_point now) {
    families_->reloads.Add({{"outcome", outcomeOfReload(sound)}}).Increment();
    if (sound) families_->lastReload.Set(secondsOf(now));
}

std::string Metrics::text() const {
    return prometheus::TextSerializer().Serialize(families_->registry.Collect());
}

}  // namespace scancast
