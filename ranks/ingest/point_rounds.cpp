#include "ranks/ingest/point_rounds.hpp"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <future>
#include <mutex>

namespace scancast {

namespace {

constexpr std::uint64_t leastCrate = std::uint64_t(64) << 10;

/// Before each run.
struct RunHead {
    std::uint32_t chunk = 0, isHalo = 0;
    std::uint64_t points = 0;
};

/// Runs for others, in crates of bounded size that are sent one after the other; the memory of all of them is kept for the next round.
class Crates {
  public:
    void begin(std::uint64_t most) {
        most_ = most;
        used_ = 0;
    }
    void add(const ChunkRun& run, std::size_t rowBytes) {
        const std::size_t row = run.halo ? 0 : rowBytes;
        for (std::size_t first = 0; first < run.points.size();) {
            const std::size_t some = std::min(run.points.size() - first, roomFor(sizeof(BuildPoint) + row));
            const RunHead head{run.chunk, run.halo, some};
            RankBytes& to = crates_[used_ - 1];
            for (const std::span<const std::byte> part :
                 {std::as_bytes(std::span(&head, 1)), std::as_bytes(run.points.subspan(first, some)),
                  run.rows.subspan(first * row, some * row)})
                to.insert(to.end(), part.begin(), part.end());
            first += some;
        }
    }
    std::size_t size() const { return used_; }
    std::span<const std::byte> operator[](std::size_t step) const {
        return step < used_ ? std::span<const std::byte>(crates_[step]) : std::span<const std::byte>();
    }

  private:
    /// How many things of this size go into the last crate, behind a head; one at least, into a new one if need be.
    std::size_t roomFor(std::size_t bytes) {
        const auto left = [&] {
            const std::uint64_t filled = crates_[used_ - 1].size() + sizeof(RunHead);
            return filled < most_ ? std::size_t((most_ - filled) / bytes) : 0;
        };
        if (used_ > 0 && left() > 0) return left();
        if (used_ == crates_.size()) crates_.emplace_back();
        crates_[used_++].clear();
        return std::max<std::size_t>(1, left());
    }

    std::uint64_t most_ = 0;
    std::size_t used_ = 0;
    std::vector<RankBytes> crates_;
};

/// Runs for this rank are filled in, others wait until the round ends.
class Parcels final : public ChunkTaker {
  public:
    Parcels(ChunkFiller& own, const ChunkOwners& owners, std::size_t rowBytes, const Communicator& ranks)
        : own_(own),
          owners_(owners),
          rowBytes_(rowBytes),
          rank_(ranks.rank()),
          parcels_(std::size_t(ranks.size())),
          locks_(std::size_t(ranks.size())) {}

    void begin(std::uint64_t mostForOne) {
        for (Crates& crates : parcels_) crates.begin(mostForOne);
    }
    Expected<void> take(const ChunkRun& run) override {
        const auto owner = std::size_t(owners_[run.chunk]);
        if (int(owner) == rank_) return own_.take(run);
        const std::lock_guard lock(locks_[owner]);
        parcels_[owner].add(run, rowBytes_);
        return {};
    }

    /// As many exchanges as it takes until all of it has been sent.
    std::uint64_t steps() const {
        std::size_t most = 0;
        for (const Crates& crates : parcels_) most = std::max(most, crates.size());
        return most;
    }
    std::vector<std::span<const std::byte>> of(std::size_t step) const {
        std::vector<std::span<const std::byte>> out;
        for (const Crates& crates : parcels_) out.push_back(crates[step]);
        return out;
    }

  private:
    ChunkFiller& own_;
    const ChunkOwners& owners_;
    const std::size_t rowBytes_;
    const int rank_;
    std::vector<Crates> parcels_;
    std::vector<std::mutex> locks_;
};

Expected<void> unpack(std::span<const std::byte> crate, std::size_t rowBytes, const ChunkOwners& owners,
                      int rank, ChunkFiller& filler) {
    std::vector<BuildPoint> points;
    while (!crate.empty()) {
        RunHead head;
        if (crate.size() < sizeof head)
            return fail(ErrorCode::Internal, "A rank was sent half a parcel of points.");
        std::memcpy(&head, crate.data(), sizeof head);
        crate = crate.subspan(sizeof head);
        const std::size_t row = head.isHalo ? 0 : rowBytes;
        if (head.points > crate.size() / (sizeof(BuildPoint) + row) || head.chunk < owners.firstOf(rank) ||
            head.chunk >= owners.endOf(rank))
            return fail(ErrorCode::Internal, "A rank was sent points that are not its own.");
        points.resize(head.points);
        std::memcpy(points.data(), crate.data(), head.points * sizeof(BuildPoint));
        crate = crate.subspan(head.points * sizeof(BuildPoint));
        if (auto ok = filler.take({head.chunk, head.isHalo != 0, points, crate.first(head.points * row)});
            !ok)
            return ok;
        crate = crate.subspan(head.points * row);
    }
    return {};
}

/// What has come of a round. Only an exchange that failed ends all of it at once: what was unpacked badly the others have yet to hear.
struct Given {
    Expected<void> exchanged, unpacked;
};

}  // namespace

Expected<std::vector<Chunk>> pointsToOwners(PointPortions& portions, const ChunkLayout& layout,
                                            const ChunkOwners& owners, std::size_t rowBytes,
                                            const RoundRoom& room, ProgressMeter& progress,
                                            const std::stop_token& stop) {
    const Communicator& ranks = room.ranks;
    ChunkFiller filler(rowBytes);
    Expected<void> done =
        filler.begin(layout, owners.firstOf(ranks.rank()), owners.endOf(ranks.rank()), room.workspace);
    std::array<Parcels, 2> parcels{Parcels(filler, owners, rowBytes, ranks),
                                   Parcels(filler, owners, rowBytes, ranks)};
    std::vector<RankBytes> received;
    const auto give = [&](const Parcels& from, std::uint64_t steps) {
        Given given;
        for (std::size_t step = 0; step < steps; ++step) {
            given.exchanged = ranks.exchange(from.of(step), received);
            if (!given.exchanged) return given;
            for (const RankBytes& crate : received)
                if (given.unpacked) given.unpacked = unpack(crate, rowBytes, owners, ranks.rank(), filler);
        }
        return given;
    };
    const auto threads = std::size_t(tbb::this_task_arena::max_concurrency());
    const std::uint64_t portionBytes = PointSource::batchPoints * (sizeof(BuildPoint) * 3 / 2 + rowBytes);
    const std::size_t atOnce = std::max<std::size_t>(threads, room.bytes / portionBytes);
    const std::size_t together = std::clamp<std::size_t>(atOnce / threads, 1, portionsAtOnce);

    std::future<Given> giving;  // a round is on its way while the next one is sorted
    std::size_t at = 0;
    for (int round = 0;; ++round) {
        Parcels& mine = parcels[std::size_t(round % 2)];
        mine.begin(std::max(leastCrate, room.bytes / unsigned(ranks.size())));
        const std::size_t end = std::min(at + atOnce, portions.size());
        if (done && at < end)
            done = sortIntoChunks(portions, at, end, layout, rowBytes, mine, progress, stop, together);
        if (giving.valid()) {
            const Given given = giving.get();
            if (!given.exchanged) return passOn(given.exchanged);
            if (done) done = given.unpacked;
        }
        if (!done) room.alarm.ring();
        std::array<std::uint64_t, 3> flags{at < end, !done,
                                           mine.steps()};  // somebody goes on; somebody cannot
        at = end;
        if (auto ok = ranks.max(flags); !ok) return passOn(ok);
        if (flags[0] == 0 || flags[1] != 0) break;
        giving = std::async(std::launch::async, give, std::cref(mine), flags[2]);
    }
    if (auto all = ranks.agree(done); !all) return passOn(all);
    return ranks.agree(filler.finish());
}

}  // namespace scancast
