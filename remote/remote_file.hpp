// One object in object storage as bytes at any offset. It is fetched in pieces of 64 KB; what is wanted at once and stands side by
// side comes with one request, and several requests are under way. Pieces stay in memory for a while, and on disk where there is a
// folder for them.
//
// While its server cannot be reached, whatever is not here fails at once, with Unavailable: nobody waits for it twice. It is asked
// again by itself, ever less often, until it is back. An object that has been replaced by another is Unavailable for good: whoever
// wants that one opens it anew.
//
// Owned by its readers together. *Thread safety*: every function may be called from any thread; readAt() waits. Place: cloud file →
// **remote file** → transfers, piece folder.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "files/random_reader.hpp"
#include "remote/piece_folder.hpp"
#include "remote/request_pace.hpp"
#include "remote/transfers.hpp"
#include "threads/monitor.hpp"

namespace scancast {

/// What all remote files of a process have in common.
struct RemoteCommons {
    std::shared_ptr<Transfers> transfers;
    std::unique_ptr<PieceFolder> folder{};   ///< empty = nothing is kept on disk
    std::uint64_t memory = 0;                ///< bytes of pieces, of all files together
    std::shared_ptr<const void> reserved{};  ///< for that
    /// Counts what a file has at least, where there are so many that their share is less.
    std::function<std::shared_ptr<const void>(std::uint64_t bytes)> reserve{};
    PaceLimits pace{};  ///< of one file
    int tries = 3;
    std::chrono::milliseconds firstProbe{500},
        lastProbe{10000};  ///< between questions whether a server is back
    /// A file cannot be reached, is back, or has been replaced; without line break, for the log.
    std::function<void(const std::string& note)> onNote{};
    /// It has been replaced by another one.
    std::function<void()> onChanged{};
    std::atomic<std::size_t> files{0}, away{0};
    std::atomic<std::uint64_t> memoryHits{0}, diskHits{0}, misses{0};
};

class RemoteFile final : public RandomReader, public std::enable_shared_from_this<RemoteFile> {
  public:
    static constexpr std::uint64_t pieceBytes = 64 << 10;

    /// As it was found: `start` is its first piece, which `took` so long to come.
    static std::shared_ptr<RemoteFile> create(std::shared_ptr<RemoteCommons> commons,
                                              std::shared_ptr<const ObjectAccess> access,
                                              std::string identity, Part start,
                                              std::chrono::nanoseconds took);
    ~RemoteFile() override;

    std::uint64_t size() const override { return state_.bytes; }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override;
    void expect(std::uint64_t offset, std::uint64_t bytes) const override;
    bool forget(std::uint64_t offset, std::uint64_t bytes) const override;
    bool isRemote() const override { return true; }
    bool isAway() const override;

    const ObjectState& state() const { return state_; }
    const std::string& shown() const { return shown_; }
    /// The same object's URL with another signature: later requests are made with it.
    void signAnew(std::shared_ptr<const ObjectAccess> access);
    /// It has been replaced by another: found out by the way, or by look().
    bool changed() const;
    /// Who fetches something else from the same place, since `begun`, got nothing: as if this had not been to be had. False, and
    /// nothing else, where this could be had again since: the request says nothing about now.
    bool lost(const RequestFault& fault, RequestPace::Time begun);
    /// Who fetches something else from the same place got it.
    void came();
    /// Why nothing can be had now: Unavailable.
    Error absence() const;
    /// What its first piece took to come.
    std::chrono::nanoseconds firstTook() const { return took_; }
    /// Asks whether it is what it was, in the background; what comes of it changes changed() and isAway().
    void look();

  private:
    using Bytes = std::shared_ptr<const std::vector<std::byte>>;
    enum class Stage : std::uint8_t {
        Wanted,
        Asked,
        Here,
        Failed,  ///< until those who waited have seen it
    };
    struct Piece {
        Stage stage = Stage::Wanted;
        Bytes bytes{};
        std::size_t waiting = 0;  ///< readers; it stays until they have it
        bool saved = false;       ///< on disk, or not to be; somebody has read it
        bool spared = false;      ///< it was its turn to go, and nobody had read it yet
        std::list<std::uint64_t>::iterator use{};
    };
    using Pieces = std::map<std::uint64_t, Piece>;
    struct Request {
        std::uint64_t first = 0, count = 0;
        RequestPace::Time begun{};
    };

    RemoteFile(std::shared_ptr<RemoteCommons> commons, std::shared_ptr<const ObjectAccess> access,
               std::string identity, ObjectState state, std::chrono::nanoseconds took);

    Expected<Bytes> bytesOf(std::uint64_t piece) const;
    Bytes fromDisk(std::uint64_t piece) const;
    std::uint64_t bytesIn(std::uint64_t piece) const;
    tl::unexpected<Error> unavailable() const;
    // With the lock held.
    void want(std::uint64_t piece) const;
    void keep(std::uint64_t piece, Bytes bytes, bool saved) const;
    void makeRoom() const;
    std::vector<Request> requestsDue() const;
    void goAway(const RequestFault& fault) const;
    /// Before the next question whether the server is back.
    std::chrono::milliseconds backOff(const RequestFault& fault) const;
    std::uint64_t share() const;
    void failPiece(std::uint64_t piece) const;
    // Without it.
    std::shared_ptr<const ObjectAccess> currentAccess() const;
    void send(const std::vector<Request>& requests) const;
    void arrived(const Request& request, PartOrFault result) const;
    void tellOfChange() const;
    void tellOfAbsence(const RequestFault& fault) const;
    /// `delay`: before it, and again and again while there is no answer; nullopt = once, now.
    void probe(std::optional<std::chrono::milliseconds> delay) const;
    void probed(const PartOrFault& result, bool again) const;
    void note(const std::string& text) const;

    const std::shared_ptr<RemoteCommons> commons_;
    const std::string shown_;
    std::shared_ptr<const ObjectAccess> access_;  // guarded by monitor_
    const ObjectState state_;
    const std::chrono::nanoseconds took_;
    const std::string key_;                       // of its pieces on disk
    const std::shared_ptr<const void> reserved_;  // beyond its share

    mutable Monitor monitor_;  // guards what follows
    mutable Pieces pieces_;
    mutable std::deque<std::uint64_t> order_;  // wanted, the first one first
    mutable std::list<std::uint64_t> uses_;    // here, the last used first
    mutable std::uint64_t bytesHere_ = 0;
    mutable std::size_t underWay_ = 0;
    mutable RequestPace pace_;
    mutable std::optional<RequestFault> away_{};
    /// The last wait for a server that was away; nullopt once a part has come: an answer of a byte does not make it well.
    mutable std::optional<std::chrono::milliseconds> backOff_{};
    mutable RequestPace::Time back_ = RequestPace::Time::min();  ///< when it was last back from being away
    mutable bool changed_ = false;
    mutable bool looking_ = false;
};

}  // namespace scancast
