#include "ranks/ingest/point_rounds.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>

namespace scancast {

namespace {

/// RankBytes that all ranks together may send one in a round, were all of it for that one.
constexpr std::uint64_t bytesOfRound = std::uint64_t(64) << 20;

/// Before each run.
struct RunHead {
    std::uint32_t chunk = 0, isHalo = 0;
    std::uint64_t points = 0;
};

/// Runs for this rank are filled in, others wait until the round ends.
class Parcels final : public ChunkTaker {
  public:
    Parcels(ChunkFiller& own, const ChunkOwners& owners, int rank, int ranks)
        : own_(own), owners_(owners), rank_(rank), parcels_(std::size_t(ranks)), locks_(std::size_t(ranks)) {}

    Expected<void> take(const ChunkRun& run) override {
        const int owner = owners_[run.chunk];
        if (owner == rank_) return own_.take(run);
        const RunHead head{run.chunk, run.halo, run.points.size()};
        const std::lock_guard lock(locks_[std::size_t(owner)]);
        RankBytes& to = parcels_[std::size_t(owner)];
        for (const std::span<const std::byte> part :
             {std::as_bytes(std::span(&head, 1)), std::as_bytes(run.points), run.rows})
            to.insert(to.end(), part.begin(), part.end());
        return {};
    }

    const std::vector<RankBytes>& parcels() const { return parcels_; }
    void clear() {
        for (RankBytes& parcel : parcels_) parcel.clear();
    }

  private:
    ChunkFiller& own_;
    const ChunkOwners& owners_;
    const int rank_;
    std::vector<RankBytes> parcels_;
    std::vector<std::mutex> locks_;
};

Expected<void> unpack(std::span<const std::byte> parcel, std::size_t rowBytes, const ChunkOwners& owners,
                      int rank, ChunkFiller& filler) {
    std::vector<BuildPoint> points;
    while (!parcel.empty()) {
        RunHead head;
        if (parcel.size() < sizeof head)
            return fail(ErrorCode::Internal, "A rank was sent half a parcel of points.");
        std::memcpy(&head, parcel.data(), sizeof head);
        parcel = parcel.subspan(sizeof head);
        const std::size_t row = head.isHalo ? 0 : rowBytes;
        if (head.points > parcel.size() / (sizeof(BuildPoint) + row) || head.chunk < owners.firstOf(rank) ||
            head.chunk >= owners.endOf(rank))
            return fail(ErrorCode::Internal, "A rank was sent points that are not its own.");
        points.resize(head.points);
        std::memcpy(points.data(), parcel.data(), head.points * sizeof(BuildPoint));
        parcel = parcel.subspan(head.points * sizeof(BuildPoint));
        if (auto ok = filler.take({head.chunk, head.isHalo != 0, points, parcel.first(head.points * row)});
            !ok)
            return ok;
        parcel = parcel.subspan(head.points * row);
    }
    return {};
}

}  // namespace

Expected<std::vector<Chunk>> pointsToOwners(PointPortions& portions, const ChunkLayout& layout,
                                            const ChunkOwners& owners, std::size_t rowBytes,
                                            Workspace& workspace, const Communicator& ranks,
                                            ProgressMeter& progress, const std::stop_token& stop) {
    ChunkFiller filler(rowBytes);
    Expected<void> done =
        filler.begin(layout, owners.firstOf(ranks.rank()), owners.endOf(ranks.rank()), workspace);
    Parcels parcels(filler, owners, ranks.rank(), ranks.size());
    const std::uint64_t portionBytes = PointSource::batchPoints * (sizeof(BuildPoint) * 3 / 2 + rowBytes);
    const std::size_t atOnce =
        std::size_t(std::max<std::uint64_t>(1, bytesOfRound / unsigned(ranks.size()) / portionBytes));
    for (std::size_t at = 0;;) {
        const std::size_t end = std::min(at + atOnce, portions.size());
        if (done && at < end)
            done = sortIntoChunks(portions, at, end, layout, rowBytes, parcels, progress, stop);
        std::array<std::uint64_t, 2> flags{at < end, !done};  // somebody goes on; somebody cannot
        at = end;
        if (auto ok = ranks.max(flags); !ok) return passOn(ok);
        if (flags[0] == 0 || flags[1] != 0) break;
        const auto got = ranks.exchange(parcels.parcels());
        if (!got) return passOn(got);
        parcels.clear();
        for (const RankBytes& parcel : *got)
            if (done) done = unpack(parcel, rowBytes, owners, ranks.rank(), filler);
    }
    if (auto all = ranks.agree(done); !all) return passOn(all);
    return ranks.agree(filler.finish());
}

}  // namespace scancast
