#include "ranks/ingest/shared_sides.hpp"

#include "ranks/ingest/archive.hpp"
#include "renderer/cloud/build/nodes/build_node.hpp"

namespace scancast {

namespace {

struct AllPatches {
    std::vector<Facet> facets;
    std::vector<PatchCount> patches;
    std::vector<Border> borders;
};

/// Numbered on from what is there, as one process would have.
Expected<void> add(std::span<const std::byte> bytes, AllPatches& all) {
    BytesIn in(bytes);
    std::vector<Facet> facets;
    std::vector<PatchCount> patches;
    std::vector<Border> borders;
    in(facets);
    in(patches);
    in(borders);
    const auto before = std::uint32_t(all.patches.size());
    for (Facet& f : facets)
        if (f.patch != loosePoints) f.patch += before;
    for (Border& b : borders) b.low += before, b.high += before;
    all.facets.insert(all.facets.end(), facets.begin(), facets.end());
    all.patches.insert(all.patches.end(), patches.begin(), patches.end());
    all.borders.insert(all.borders.end(), borders.begin(), borders.end());
    return in.finish();
}

Expected<RankBytes> decide(std::vector<RankBytes> gathered, bool upIsZ) {
    AllPatches all;
    std::vector<std::uint64_t> firsts;
    for (RankBytes& one : gathered) {
        firsts.push_back(all.patches.size());
        if (auto ok = add(one, all); !ok) return passOn(ok);
        RankBytes().swap(one);
    }
    const Sides sides = decideSides(all.facets, all.patches, all.borders, upIsZ);
    BytesOut out;
    out(firsts);
    out(std::vector<std::uint8_t>(sides.turn.begin(), sides.turn.end()));
    out(sides.confidence);
    out(sides.surroundings);
    return out.take();
}

}  // namespace

Expected<Sides> decideTogether(const Expected<void>& grown, std::vector<Facet>& facets,
                               std::span<const PatchCount> patches, std::span<const Border> borders,
                               bool upIsZ, const Communicator& ranks) {
    if (auto ok = ranks.agree(grown); !ok) return passOn(ok);
    BytesOut out;
    out(facets);
    out(std::vector<PatchCount>(patches.begin(), patches.end()));
    out(std::vector<Border>(borders.begin(), borders.end()));
    giveBack(facets);
    auto gathered = ranks.gather(out.take());
    if (!gathered) return passOn(gathered);
    Expected<RankBytes> decided = RankBytes();
    if (ranks.isFirst()) decided = decide(std::move(*gathered), upIsZ);
    decided = ranks.agree(std::move(decided));
    if (!decided) return passOn(decided);
    if (auto ok = ranks.broadcast(*decided); !ok) return passOn(ok);

    BytesIn in(*decided);
    std::vector<std::uint64_t> firsts;
    std::vector<std::uint8_t> turn, confidence;
    Sides mine;
    in(firsts);
    in(turn);
    in(confidence);
    in(mine.surroundings);
    if (auto ok = in.finish(); !ok) return passOn(ok);
    const std::size_t first = firsts.at(std::size_t(ranks.rank())), end = first + patches.size();
    if (end > turn.size() || end > confidence.size())
        return fail(ErrorCode::Internal, "The sides of a rank's patches were lost.");
    mine.turn.assign(turn.begin() + std::ptrdiff_t(first), turn.begin() + std::ptrdiff_t(end));
    mine.confidence.assign(confidence.begin() + std::ptrdiff_t(first),
                           confidence.begin() + std::ptrdiff_t(end));
    return mine;
}

}  // namespace scancast
