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

RankBytes pack(const CountingGrid& grid) {
    BytesOut out;
    out(grid.frame().cellLevel);
    out(grid.cells());
    return out.take();
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

Expected<JoinedCells> joinCounts(CountingGrid mine, const GridBox& box, const Communicator& ranks) {
    const auto join = [&](std::span<const std::byte> bytes) -> Expected<void> {
        BytesIn in(bytes);
        const int cellLevel = in.get<int>();
        std::vector<CountedCell> cells;
        in(cells);
        if (auto ok = in.finish(); !ok) return ok;
        mine.join(CountingGrid::of(box, cellLevel, cells));
        return {};
    };
    if (auto ok = ranks.join([&] { return pack(mine); }, join); !ok) return passOn(ok);
    JoinedCells joined{.frame = mine.frame(), .cells = mine.cells()};
    BytesOut out;
    out(joined.frame);
    out(joined.cells);
    RankBytes all = ranks.isFirst() ? out.take() : RankBytes();
    if (auto ok = ranks.broadcast(all); !ok) return passOn(ok);
    BytesIn in(all);
    in(joined.frame);
    in(joined.cells);
    if (auto ok = in.finish(); !ok) return passOn(ok);
    return joined;
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
