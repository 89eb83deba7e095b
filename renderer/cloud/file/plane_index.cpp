#include "renderer/cloud/file/plane_index.hpp"

#include <spdlog/fmt/fmt.h>

#include "renderer/cloud/file/node_index.hpp"

namespace scancast {

namespace {

const char* wrongPlace(const BlockPlace& place, const BlockList& list, const Node& node,
                       std::uint64_t indexOffset) {
    if (list.mayBeMissing && place == BlockPlace{}) return nullptr;
    const bool mayHave = node.isLeaf() || list.inInnerNodes;
    return wrongBlock(place, mayHave ? node.sampleCount * std::uint64_t(list.recordBytes) : 0, indexOffset);
}

}  // namespace

std::size_t rowBytes(std::span<const KeptColumn> columns) {
    std::size_t bytes = 0;
    for (const KeptColumn& kept : columns) bytes += bytesOf(kept.column.type);
    return bytes;
}

std::vector<BlockList> listsBesideSamples(const CloudFacts& facts, std::uint32_t version) {
    if (version == 1)
        return {{.what = "rows",
                 .recordBytes = rowBytes(facts.columns),
                 .inInnerNodes = false,
                 .mayBeMissing = false}};
    std::vector<BlockList> lists;
    for (const ValuePlane& plane : planesOf(facts))
        lists.push_back({.what = "plane " + plane.name,
                         .recordBytes = bytesOf(plane.type),
                         .inInnerNodes = plane.of == ValuePlane::Of::Samples,
                         .mayBeMissing = lists.size() >= facts.columns.size()});
    return lists;
}

Expected<void> checkPlaces(std::span<const BlockPlace> places, std::span<const BlockList> lists,
                           std::span<const StoredNode> nodes, std::uint64_t indexOffset) {
    if (places.size() != nodes.size() * lists.size())
        return fail(
            ErrorCode::Malformed,
            fmt::format("the index of planes has {} places, not one for each of {} nodes and {} planes",
                        places.size(), nodes.size(), lists.size()));
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::size_t node = i / lists.size();
        const BlockList& list = lists[i % lists.size()];
        if (const char* wrong = wrongPlace(places[i], list, nodes[node].node, indexOffset))
            return fail(ErrorCode::Malformed,
                        fmt::format("node {} of the index, {}: {}", node, list.what, wrong));
    }
    return {};
}

}  // namespace scancast
