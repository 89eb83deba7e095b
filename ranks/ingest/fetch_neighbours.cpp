#include <algorithm>
#include <array>

#include "ranks/ingest/archive.hpp"
#include "ranks/ingest/shared_tree.hpp"
#include "renderer/cloud/build/finish.hpp"
#include "renderer/cloud/build/nodes/inner_surfels.hpp"

namespace scancast {

namespace {

/// Numbers of others' nodes near this rank's, by who owns them, each once.
std::vector<std::vector<std::uint32_t>> wantedFrom(NumberedTree& tree, std::span<BuildNode* const> own,
                                                   const Communicator& ranks) {
    std::vector<bool> isWanted(tree.size());
    const BuildNode& root = tree.node(0);
    for (const BuildNode* node : own)
        for (const BuildNode* neighbour : neighboursOf(*node, root))
            isWanted[tree.numberOf(*neighbour)] = true;
    std::vector<std::vector<std::uint32_t>> wanted(std::size_t(ranks.size()));
    for (std::uint32_t n = 0; n < tree.size(); ++n)
        if (isWanted[n] && tree.ownerOf(n) != ranks.rank()) wanted[std::size_t(tree.ownerOf(n))].push_back(n);
    return wanted;
}

Expected<void> takeSamples(std::span<const std::byte> bytes, NumberedTree& tree, Workspace& workspace) {
    BytesIn in(bytes);
    std::vector<Sample> samples;
    while (in.isSound() && !in.isAtEnd()) {
        const auto number = in.get<std::uint32_t>();
        in(samples);
        if (number >= tree.size() || samples.size() != tree.node(number).stored.node.sampleCount)
            return fail(ErrorCode::Internal, "A rank was sent other samples than it asked for.");
        auto room = workspace.allocate(samples.size() * sizeof(Sample));
        if (!room) return passOn(room);
        if (auto ok = room->write(0, std::as_bytes(std::span(samples))); !ok) return ok;
        tree.node(number).setAside = std::move(*room);
    }
    return in.finish();
}

}  // namespace

Expected<void> fetchNeighbours(NumberedTree& tree, std::span<BuildNode* const> own, const BlockSink& shelf,
                               Workspace& workspace, std::uint64_t bytesAtOnce, const Communicator& ranks) {
    std::vector<RankBytes> asking;
    for (const auto& numbers : wantedFrom(tree, own, ranks)) {
        BytesOut out;
        out(numbers);
        asking.push_back(out.take());
    }
    const auto asked = ranks.exchange(asking);
    if (!asked) return passOn(asked);
    std::vector<std::vector<std::uint32_t>> wanted(asked->size());
    Expected<void> done;
    for (std::size_t r = 0; r < asked->size(); ++r) {
        BytesIn in((*asked)[r]);
        in(wanted[r]);
        if (done) done = in.finish();
    }
    const std::uint64_t mostForOne = std::max<std::uint64_t>(1, bytesAtOnce / unsigned(ranks.size()));
    std::vector<std::size_t> next(wanted.size());
    for (;;) {
        std::vector<RankBytes> out(wanted.size());
        bool goesOn = false;
        for (std::size_t r = 0; r < wanted.size() && done; ++r) {
            BytesOut parcel;
            for (std::uint64_t bytes = 0; next[r] < wanted[r].size() && bytes < mostForOne && done;) {
                const std::uint32_t number = wanted[r][next[r]++];
                if (number >= tree.size() || tree.ownerOf(number) != ranks.rank()) {
                    done = fail(ErrorCode::Internal, "A rank was asked for samples that it does not have.");
                    break;
                }
                const auto samples = samplesOf(tree.node(number), &shelf);
                if (!samples) {
                    done = passOn(samples);
                    break;
                }
                parcel(number);
                parcel(*samples);
                bytes += samples->size() * sizeof(Sample);
                goesOn = true;
            }
            out[r] = parcel.take();
        }
        std::array<std::uint64_t, 2> flags{goesOn, !done};  // somebody has something to send; somebody cannot
        if (auto ok = ranks.max(flags); !ok) return ok;
        if (flags[0] == 0 || flags[1] != 0) return ranks.agree(done);
        const auto got = ranks.exchange(out);
        if (!got) return passOn(got);
        for (const RankBytes& parcel : *got)
            if (done) done = takeSamples(parcel, tree, workspace);
    }
}

}  // namespace scancast
