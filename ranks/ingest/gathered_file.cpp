#include "ranks/ingest/gathered_file.hpp"

#include <algorithm>
#include <array>

#include "ranks/ingest/archive.hpp"

namespace scancast {

namespace {

constexpr int blocksTag = 2;
constexpr std::uint64_t pieceBytes = std::uint64_t(4) << 20;

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
        while (fetched_ < bytes_)
            if (auto ok = fetch(); !ok) return ok;
        return {};
    }

  private:
    Expected<void> fetch() {
        if (fetched_ == bytes_) return fail(ErrorCode::Internal, "A rank sent fewer blocks than it has.");
        piece_.resize(std::min(pieceBytes, bytes_ - fetched_));
        at_ = 0;
        auto got = rank_ == 0 ? own_.read(fetched_, piece_) : ranks_.receive(piece_, rank_, blocksTag);
        fetched_ += piece_.size();
        return got;
    }

    const int rank_;
    const std::uint64_t bytes_;
    const BlockShelf& own_;
    const Communicator& ranks_;
    RankBytes piece_;
    std::size_t at_ = 0;
    std::uint64_t fetched_ = 0;
};

struct Sizes {
    std::uint64_t held = 0, leaves = 0, all = 0;
};

class Gathering {
  public:
    Gathering(NumberedTree& tree, CloudFileWriter& file, std::vector<ShelfStream>& streams,
              std::vector<Sizes> sizes)
        : tree_(tree), file_(file), streams_(streams), sizes_(std::move(sizes)) {}

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
        RankBytes piece;
        for (std::uint64_t done = 0; done < bytes; done += piece.size()) {
            piece.resize(std::min(pieceBytes, bytes - done));
            if (auto ok = from.read(piece); !ok) return ok;
            if (auto place = file_.append(piece); !place) return passOn(place);
        }
        return {};
    }

    Expected<void> moveBlock(ShelfStream& from, BlockPlace& place) {
        if (place.bytes == 0) return {};
        block_.resize(place.bytes);
        if (auto ok = from.read(block_); !ok) return ok;
        auto written = file_.append(block_);
        if (!written) return passOn(written);
        if (written->checksum != place.checksum)
            return fail(ErrorCode::Io,
                        "A block is not what it was when it was made; is the disk of --scratch failing?");
        place = *written;
        return {};
    }

    NumberedTree& tree_;
    CloudFileWriter& file_;
    std::vector<ShelfStream>& streams_;
    const std::vector<Sizes> sizes_;
    RankBytes block_;
};

Expected<void> gather(NumberedTree& tree, std::span<BuildNode* const> inner, const BlockShelf& shelf,
                      std::vector<Sizes> sizes, CloudFileWriter& file, const Communicator& ranks) {
    std::vector<ShelfStream> streams;
    for (int r = 0; r < ranks.size(); ++r) streams.emplace_back(r, sizes[std::size_t(r)].all, shelf, ranks);
    const auto done = Gathering(tree, file, streams, std::move(sizes)).run(inner);
    for (ShelfStream& stream : streams)
        if (auto ok = stream.drain(); !ok && done) return ok;
    return done;
}

Expected<void> sendShelf(const BlockShelf& shelf, const Communicator& ranks) {
    Expected<void> done;
    RankBytes piece;
    for (std::uint64_t at = 0; at < shelf.bytes(); at += piece.size()) {
        piece.assign(std::min(pieceBytes, shelf.bytes() - at), std::byte(0));
        if (done) done = shelf.read(at, piece);  // what cannot be read is not waited for in vain
        if (auto ok = ranks.send(piece, 0, blocksTag); !ok) return ok;
    }
    return done;
}

}  // namespace

Expected<void> gatherFile(NumberedTree& tree, std::span<BuildNode* const> inner, const BlockShelf& shelf,
                          const ShelfParts& parts, CloudFileWriter* file, const Communicator& ranks) {
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
    return ranks.agree(ranks.isFirst() ? gather(tree, inner, shelf, std::move(sizes), *file, ranks)
                                       : sendShelf(shelf, ranks));
}

}  // namespace scancast
