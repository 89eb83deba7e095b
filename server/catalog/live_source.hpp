// A cloud that changes: frames are read from a pipe as they come, each becomes a cloud of its own, and takes the place
// of the one before in the catalog. Latest wins: a frame that waits while another one is built is replaced by the next
// one, and counted. Pipeline: bytes → frames → **live source** → catalog.
//
// The first frame decides how the cloud is looked at - camera, colours, origin -, and that is kept. At the end of the
// bytes the last cloud stays; a named pipe then waits for its next writer. A stream that breaks its rules is read no
// further, because nobody knows where its next frame would begin; the last sound frame stays.
//
// Owned by `serve`. Two threads of its own: one reads, one builds. *Thread safety*: its functions may be called from any
// thread; callbacks come from either thread.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "renderer/cloud/build/frame/frame_cloud.hpp"
#include "renderer/cloud/point_batch.hpp"
#include "renderer/residency/block_cache.hpp"
#include "server/base/faults.hpp"
#include "server/base/metrics.hpp"
#include "server/catalog/catalog.hpp"
#include "threads/monitor.hpp"

namespace scancast {

class FrameReader;
class LiveBytes;

/// What `--live NAME=PATH` says.
struct LiveInput {
    std::string name;
    std::filesystem::path path;  ///< "-" = standard input
};
/// InvalidArgument for anything else.
Expected<LiveInput> parseLiveInput(const std::string& text);

struct LiveOptions {
    int threads = 0;  ///< 0 = all cores
    bool surfels = true;
    std::shared_ptr<BlockCache> cache;  ///< its limit bounds the points of a frame
    Metrics* metrics = nullptr;         ///< outlives the source; null = nothing is counted there
    std::function<void()> onChanged;    ///< another cloud, or another status, is in the catalog
    std::function<void(const std::string&line)> onNote, onFailure;  ///< for people, with the cloud's id
    std::chrono::milliseconds noteInterval{10'000};                 ///< between lines about skipped frames
};

/// Points that a frame may have: while one is shown, one is built, one waits, and one is read.
std::uint64_t mostFramePoints(std::uint64_t memoryLimit);

class LiveSource {
  public:
    /// The entry is in the catalog when this returns, and its bytes are being opened. The catalog outlives the source.
    LiveSource(LiveInput input, Catalog& catalog, LiveOptions options);
    /// requestStop(), then waits.
    ~LiveSource();
    LiveSource(const LiveSource&) = delete;
    LiveSource& operator=(const LiveSource&) = delete;

    const std::string& id() const { return id_; }
    void requestStop();
    /// Nothing more is read or built.
    bool finished() const;
    /// It is finished, and there was no frame to show.
    bool failed() const;

  private:
    using Clock = std::chrono::steady_clock;
    struct Arrived {
        PointFrame frame;
        Clock::time_point at;
    };

    void readAll();
    void readFrom(std::unique_ptr<LiveBytes> bytes);
    void readFrames(FrameReader& frames);
    void arrived(PointFrame frame);
    void buildAll();
    bool buildNext();
    void build(const Arrived& arrived);
    void shown(std::shared_ptr<const Cloud> cloud, Clock::time_point arrivedAt);
    void frameFailed(const Error& error);
    void ended(LiveStatus::State state, std::string error);
    void tellSkipped(bool atEnd);
    void publish(std::shared_ptr<const Cloud> cloud = nullptr);
    void count(LiveOutcome outcome);

    const LiveInput input_;
    Catalog& catalog_;
    const LiveOptions options_;
    const std::string id_;
    FaultLog failures_;
    std::optional<FrameBasis> basis_;  // the building thread's
    Clock::time_point nextNote_;       // the reading thread's, as is the next
    std::uint64_t skippedTold_ = 0;

    std::stop_source stop_;
    mutable Monitor monitor_;  // guards what follows
    std::optional<Arrived> waiting_;
    bool allRead_ = false, finished_ = false;
    LiveStatus status_;
    std::mutex publishing_;  // the catalog hears of statuses in their order
    std::thread reader_, builder_;
};

}  // namespace scancast
