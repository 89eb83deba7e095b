#include "ranks/ingest/gathered_file.hpp"

#include <algorithm>
#include <array>

#include "ranks/ingest/archive.hpp"
#include "renderer/cloud/build/progress_meter.hpp"

namespace scancast {

namespace {

constexpr int blocksTag = 2;
constexpr std::uint64_t pieceBytes = std::uint64_t(4) << 20;

tl::unexpected<Error> abandoned() {
    return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
}

/// What rank 0 does not know yet of an inner node that was finished elsewhere.
template <class Node, class Visit>
void forFinished(Node& node, Visit visit) {
    visit(node.content.cone);
    visit(node.sampleHash);
    visit(node.stored.samples);
    visit(node.beside);
}

/// A shelf's bytes as they come, front to back: rank 0's own, or another's.
class ShelfStream {
  public:
    ShelfStream(int rank, std::uint64_t bytes, const BlockShelf& own, const Communicator& ranks)
        : rank_(rank), bytes_(bytes), own_(own), ranks_(ranks) {}

    Expected<void> read(std::span<std::byte> into) {
        while (!into.empty()) {
            if (at_ == piece_.size())
                if (auto ok = fetch(); !ok) return ok;
            const auto some = std::min(into.size(), piece_.size() - at_);
            std::copy_n(piece_.begin() + std::ptrdiff_t(at_), some, into.begin());
            at_ += some;
            into = into.subspan(some);
        }
        return {};
    }
    /// What is left, and of no use: whoever sends it waits for somebody to take it.
    Expected<void> drain() {
        while (rank_ != 0 && !hasEnded_ && fetched_ < bytes_)
            if (auto ok = fetch(); !ok && !hasEnded_) return ok;
        return {};
    }

  private:
    Expected<void> fetch() {
        if (hasEnded_) return abandoned();
        if (fetched_ == bytes_) return fail(ErrorCode::Internal, "A rank sent fewer blocks than it has.");
        piece_.resize(std::min(pieceBytes, bytes_ - fetched_));
        at_ = 0;
        fetched_ += piece_.size();
        if (rank_ == 0) return own_.read(fetched_ - piece_.size(), piece_);
        const auto got = ranks_.receiveSome(piece_, rank_, blocksTag);
        if (!got) return passOn(got);
        hasEnded_ = *got < piece_.size();
        return hasEnded_ ? abandoned() : Expected<void>();
    }

    const int rank_;
    const std::uint64_t bytes_;
    const BlockShelf& own_;
    const Communicator& ranks_;
    RankBytes piece_;
    std::size_t at_ = 0;
    std::uint64_t fetched_ = 0;
    bool hasEnded_ = false;  ///< too early: who sends has given up, and says why when all agree
};

struct Sizes {
    std::uint64_t held = 0, leaves = 0, all = 0;
};

class Gathering {
  public:
    Gathering(NumberedTree& tree, CloudFileWriter& file, std::vector<ShelfStream>& streams,
              std::vector<Sizes> sizes, ProgressMeter& progress, const std::stop_token& stop)
        : tree_(tree),
          file_(file),
          streams_(streams),
          sizes_(std::move(sizes)),
          progress_(progress),
          stop_(stop) {}

    Expected<void> run(std::span<BuildNode* const> inner) {
        std::vector<std::uint64_t> heldAt, leavesAt;
        for (std::size_t r = 0; r < streams_.size(); ++r) {
            heldAt.push_back(file_.bytesWritten());
            if (auto ok = copy(streams_[r], sizes_[r].held); !ok) return ok;
        }
        for (std::size_t r = 0; r < streams_.size(); ++r) {
            leavesAt.push_back(file_.bytesWritten() - sizes_[r].held);
            if (auto ok = copy(streams_[r], sizes_[r].leaves - sizes_[r].held); !ok) return ok;
        }
        for (std::uint32_t n = 0; n < tree_.size(); ++n) {
            BuildNode& node = tree_.node(n);
            if (!node.isLeaf()) continue;
            const auto r = std::size_t(tree_.ownerOf(n));
            const auto move = [&](BlockPlace& place) {
                if (place.bytes > 0) place.offset += place.offset < sizes_[r].held ? heldAt[r] : leavesAt[r];
            };
            move(node.stored.samples);
            for (BlockPlace& place : node.columns) move(place);
            for (BlockPlace& place : node.positions) move(place);
            move(node.beside.curvature);
            move(node.beside.nearInfrared);
        }
        for (BuildNode* node : inner) {
            ShelfStream& from = streams_[std::size_t(tree_.ownerOf(tree_.numberOf(*node)))];
            for (BlockPlace* place :
                 {&node->stored.samples, &node->beside.curvature, &node->beside.nearInfrared})
                if (auto ok = moveBlock(from, *place); !ok) return ok;
        }
        return {};
    }

  private:
    Expected<void> copy(ShelfStream& from, std::uint64_t bytes) {
        for (std::uint64_t done = 0; done < bytes; done += block_.size()) {
            block_.resize(std::min(pieceBytes, bytes - done));
            if (auto ok = from.read(block_); !ok) return ok;
            if (auto written = append(); !written) return passOn(written);
        }
        return {};
    }

    Expected<void> moveBlock(ShelfStream& from, BlockPlace& place) {
        if (place.bytes == 0) return {};
        block_.resize(place.bytes);
        if (auto ok = from.read(block_); !ok) return ok;
        auto written = append();
        if (!written) return passOn(written);
        if (written->checksum != place.checksum)
            return fail(ErrorCode::Io,
                        "A block is not what it was when it was made; is the disk of --scratch failing?");
        place = *written;
        return {};
    }

    Expected<BlockPlace> append() {
        if (stop_.stop_requested()) return abandoned();
        auto written = file_.append(block_);
        if (written) progress_.add(block_.size());
        return written;
    }

    NumberedTree& tree_;
    CloudFileWriter& file_;
    std::vector<ShelfStream>& streams_;
    const std::vector<Sizes> sizes_;
    ProgressMeter& progress_;
    const std::stop_token& stop_;
    RankBytes block_;
};

Expected<void> gather(NumberedTree& tree, std::span<BuildNode* const> inner, const BlockShelf& shelf,
                      std::vector<Sizes> sizes, CloudFileWriter& file, const GatheringRoom& room) {
    std::vector<ShelfStream> streams;
    std::uint64_t bytes = 0;
    for (int r = 0; r < room.ranks.size(); ++r) {
        streams.emplace_back(r, sizes[std::size_t(r)].all, shelf, room.ranks);
        bytes += sizes[std::size_t(r)].all;
    }
    ProgressMeter writing(room.progress, "writing", bytes, "bytes");
    const auto done = Gathering(tree, file, streams, std::move(sizes), writing, room.stop).run(inner);
    if (!done) room.alarm.ring();  // nobody need send what nobody writes
    for (ShelfStream& stream : streams)
        if (auto ok = stream.drain(); !ok && done) return ok;
    if (done) writing.finish();
    return done;
}

Expected<void> sendShelf(const BlockShelf& shelf, const GatheringRoom& room) {
    RankBytes piece;
    for (std::uint64_t at = 0; at < shelf.bytes(); at += piece.size()) {
        piece.resize(std::min(pieceBytes, shelf.bytes() - at));
        const auto read = room.stop.stop_requested() ? abandoned() : shelf.read(at, piece);
        if (!read) {
            room.alarm.ring();
            if (auto ok = room.ranks.sendNothing(0, blocksTag); !ok) return ok;
            return read;
        }
        // Others' shelves may come first; from its first piece on, rank 0 takes this one.
        const auto pace = at == 0 ? Communicator::Pace::Patient : Communicator::Pace::Brisk;
        if (auto ok = room.ranks.send(piece, 0, blocksTag, pace); !ok) return ok;
    }
    return {};
}

}  // namespace

Expected<void> gatherFile(NumberedTree& tree, std::span<BuildNode* const> inner, const BlockShelf& shelf,
                          const ShelfParts& parts, CloudFileWriter* file, const GatheringRoom& room) {
    const Communicator& ranks = room.ranks;
    BytesOut out;
    out(Sizes{parts.held, parts.leaves, shelf.bytes()});
    for (BuildNode* node : inner)
        if (tree.ownerOf(tree.numberOf(*node)) == ranks.rank())
            forFinished(*node, [&](const auto& value) { out(value); });
    const auto gathered = ranks.gather(out.take());
    if (!gathered) return passOn(gathered);
    std::vector<Sizes> sizes;
    Expected<void> done;
    if (ranks.isFirst()) {
        std::vector<BytesIn> in;
        for (const RankBytes& one : *gathered) in.emplace_back(one);
        for (BytesIn& one : in) sizes.push_back(one.get<Sizes>());
        for (BuildNode* node : inner)
            forFinished(*node,
                        [&](auto& value) { in[std::size_t(tree.ownerOf(tree.numberOf(*node)))](value); });
        for (const BytesIn& one : in)
            if (done) done = one.finish();
    }
    if (auto ok = ranks.agree(done); !ok) return ok;
    return ranks.agree(ranks.isFirst() ? gather(tree, inner, shelf, std::move(sizes), *file, room)
                                       : sendShelf(shelf, room));
}

}  // namespace scancast
