// What a cloud file of any version says of itself, read and checked: all of it but its blocks. Any thread.
// Pipeline: bytes → **contents** → cloud file.
#pragma once

#include <cstdint>
#include <vector>

#include "files/random_reader.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/plane_index.hpp"

namespace scancast {

/// What a file of any version says of itself.
struct FileContents {
    std::uint32_t version = cloudFileVersion;
    StoredFacts facts;
    std::vector<StoredNode> nodes;
    std::vector<BlockList> lists;    ///< what there is beside the samples
    std::vector<BlockPlace> places;  ///< where: one for each node and list, node by node

    /// Which list a plane's values are in: in version 1, all in the rows.
    std::size_t listOf(std::size_t plane) const { return version == 1 ? 0 : plane; }
    const BlockPlace& place(std::uint32_t node, std::size_t list) const {
        return places[node * lists.size() + list];
    }
};

/// Errors without the file's name, with the byte or the node: Unsupported, Truncated, Malformed, Io. Throws
/// std::bad_alloc.
Expected<FileContents> readContents(const RandomReader& reader);

}  // namespace scancast
