// What the server counts, and its text for Prometheus (`/metrics`). Names and units are those of PROTOCOL.md.
//
// Owned by the server; one per process. *Thread safety*: every function may be called from any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "remote/remote_files.hpp"
#include "renderer/residency/block_cache.hpp"
#include "server/base/queue_lengths.hpp"
#include "server/base/transient_memory.hpp"

namespace scancast {

/// Why a picture that somebody asked for was never shown.
enum class DropReason : std::uint8_t {
    Overwritten,  ///< a newer view of the same session came first (latest wins)
    Abandoned,    ///< a still that a new view interrupted
    Deadline,     ///< waited or rendered for too long
    Failed,       ///< the renderer reported an error
    Gone,         ///< the client left
    Lacking,      ///< a still for which samples were still to be read; it is tried again
};

/// Whose limit of cost a picture would have exceeded (server/price/admission.hpp).
enum class CostRefusal : std::uint8_t { Picture, Client, Total };

/// Why somebody who connected was sent away (server/net/clients/connection_register.hpp).
enum class ConnectionRefusal : std::uint8_t {
    Full,          ///< all connections are taken, none of them idle
    Address,       ///< all are that one address may have, none of them idle
    ShuttingDown,  ///< the server is
};

/// Why a token let nobody in (server/net/access.hpp). That none came is no failure: browsers ask before they know that they need one.
enum class LoginFailure : std::uint8_t {
    Malformed,  ///< what was sent is no token
    Unknown,    ///< it is not one of this server's, or no longer
    Expired,    ///< a guest's, whose time is over
};

/// What became of a frame of a live source.
enum class LiveOutcome : std::uint8_t {
    Shown,
    Skipped,  ///< a newer one had come before it was built (latest wins)
    Failed,   ///< it could not be read or built
};

/// What became of a line of the request log.
enum class LogLine : std::uint8_t {
    Written,
    Repeated,  ///< left out, and counted in a line that tells of many
    Lost,      ///< nobody read the log
};

/// The ranks behind a front (ranks/front/).
struct RanksStats {
    bool up = false;  ///< they draw
    std::uint64_t restarts = 0;
};

class Metrics {
  public:
    /// `version` and the names of what was built become labels of scancast_build_info.
    explicit Metrics(std::string_view version);
    ~Metrics();
    Metrics(const Metrics&) = delete;
    Metrics& operator=(const Metrics&) = delete;

    /// Not `complete`: ancestors stood in for blocks that were not in memory.
    void frameRendered(std::string_view method, double seconds, bool complete = true);
    void frameEncoded(double seconds, std::uint64_t bytes);
    /// A frame went to a stream; `viewToFrameSeconds` counts from the arrival of the view that it shows.
    /// `away`: coarser than it would be, because a part of the server is out of reach.
    void frameSent(double viewToFrameSeconds, bool away = false);
    /// Of these: one that was drawn and encoded for the session that its own follows.
    void frameShared();
    void frameDropped(DropReason reason);
    /// A picture was taken on that is priced at so many seconds of a core.
    void pictureAdmitted(double coreSeconds);
    void pictureRefused(CostRefusal why);
    /// One that was taken on has been drawn (nullopt), or has ended otherwise.
    void priceEnded(std::optional<DropReason> why, double coreSeconds);
    /// From when it was asked for to its first turn on the device; `kind` is of a static table: "moving".
    void pictureWaited(std::string_view kind, double seconds);
    void setQueues(const QueueLengths& lengths);
    /// Of the last seconds, the share in which the render thread was at work.
    void setRenderSaturation(double share);
    /// The server takes nobody any more.
    void setDraining();
    /// What draws from now on; an empty name = nothing.
    void setDevice(std::string_view name, std::string_view renderer);
    void deviceLost();
    void sessionOpened();
    void sessionClosed();
    void setConnections(std::size_t now);
    void connectionRefused(ConnectionRefusal why);
    /// An idle one was closed to make room.
    void connectionDisplaced();
    void loginFailed(LoginFailure why);
    void setPointsResident(std::uint64_t points);
    /// Requests that wait for a picture now; those that share one count each.
    void setPicturesAwaited(std::size_t requests);
    /// Of the memory of the device that draws, for samples.
    void setDeviceMemory(std::uint64_t bytes);
    /// Of everything that counts against the memory limit, now and since the start.
    void setResidency(const BlockCacheStats& stats);
    /// The folder in which scans are kept as cloud files: what is there, what may be, and files removed since the start.
    void setKeptClouds(std::uint64_t bytes, std::uint64_t limit, std::uint64_t evicted);
    /// Of clouds in object storage.
    void setRemote(const RemoteStats& stats);
    /// Of a server that ranks draw for. Where this is never called, nothing is said of ranks.
    void setRanks(const RanksStats& stats);
    /// Of everything that is not residency, and of the process as the system sees it.
    void setMemory(const TransientMemory& memory);
    /// A connection was ended, because what it was sent was not read, or too slowly.
    void slowReaderEnded();
    /// Of a frame of a live source.
    void liveFrame(LiveOutcome outcome);
    /// From a live frame's last byte to the cloud in the catalog.
    void liveFrameShown(double seconds);
    /// `route` is a pattern ("/api/v1/clouds/{id}"), never what a client sent.
    void httpRequest(std::string_view route, int code);
    /// Of the certificate that is shown, with those above it the first to expire.
    void setCertificateExpiry(std::chrono::system_clock::time_point expires);
    /// Files were read anew, and all, or not all, were sound.
    void reloaded(bool sound, std::chrono::system_clock::time_point now);

    /// From its head to the last byte of its answer; not while it is a stream.
    void requestBegan() noexcept;
    void requestEnded() noexcept;
    void logLine(LogLine outcome);

    /// Prometheus text exposition format 0.0.4.
    std::string text() const;

  private:
    struct Families;
    std::unique_ptr<Families> families_;
};

}  // namespace scancast
