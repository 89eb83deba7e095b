#include "ranks/ingest/joined_counts.hpp"

#include "ranks/ingest/archive.hpp"

namespace scancast {

namespace {

RankBytes pack(StagedScan& scan) {
    BytesOut out;
    scan.forLearnt([&](const auto& value) { out(value); });
    return out.take();
}

Expected<void> unpack(std::span<const std::byte> bytes, StagedScan& scan) {
    BytesIn in(bytes);
    scan.forLearnt([&](auto& value) { in(value); });
    return in.finish();
}

}  // namespace

Expected<void> joinStaged(StagedScan& scan, const Communicator& ranks) {
    const auto join = [&](std::span<const std::byte> bytes) -> Expected<void> {
        StagedScan other;
        other.columnSketches.resize(scan.columnSketches.size());
        if (auto ok = unpack(bytes, other); !ok) return ok;
        scan.join(other);
        return {};
    };
    if (auto ok = ranks.join([&] { return pack(scan); }, join); !ok) return ok;
    RankBytes all = ranks.isFirst() ? pack(scan) : RankBytes();
    if (auto ok = ranks.broadcast(all); !ok) return ok;
    return ranks.agree(unpack(all, scan));
}

Expected<OrderedCells> joinCounts(CountingGrid mine, const GridBox& box, const Communicator& ranks) {
    // The whole needs no finer cells than any of its parts.
    std::uint64_t coarsest = std::uint64_t(mine.frame().cellLevel);
    if (auto ok = ranks.max(std::span(&coarsest, 1)); !ok) return passOn(ok);
    mine.coarsenTo(int(coarsest));
    OrderedCells all{.frame = mine.frame(), .cells = mine.cells()};
    const auto pack = [&] {
        BytesOut out;
        out(all.frame);
        out(all.cells);
        return out.take();
    };
    const auto unpack = [](std::span<const std::byte> bytes, OrderedCells& cells) {
        BytesIn in(bytes);
        in(cells.frame);
        in(cells.cells);
        return in.finish();
    };
    const auto join = [&](std::span<const std::byte> bytes) -> Expected<void> {
        OrderedCells theirs;
        if (auto ok = unpack(bytes, theirs); !ok) return ok;
        all = joined(std::move(all), std::move(theirs), box);
        return {};
    };
    if (auto ok = ranks.join(pack, join); !ok) return passOn(ok);
    RankBytes bytes = ranks.isFirst() ? pack() : RankBytes();
    if (auto ok = ranks.broadcast(bytes); !ok) return passOn(ok);
    if (auto ok = ranks.agree(unpack(bytes, all)); !ok) return passOn(ok);
    return all;
}

Expected<void> joinSketch(ValueSketch& sketch, const Communicator& ranks) {
    const auto join = [&](std::span<const std::byte> bytes) -> Expected<void> {
        ValueSketch other;
        BytesIn in(bytes);
        other.forFields([&](auto& value) { in(value); });
        if (auto ok = in.finish(); !ok) return ok;
        sketch.join(other);
        return {};
    };
    const auto mine = [&] {
        BytesOut out;
        sketch.forFields([&](const auto& value) { out(value); });
        return out.take();
    };
    return ranks.join(mine, join);
}

}  // namespace scancast
