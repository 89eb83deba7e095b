#include "importers/octree/potree/nodes_2.hpp"

#include <fmt/format.h>

#include <set>

#include "files/bytes.hpp"
#include "importers/octree/potree/node_names.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::size_t entryBytes = 22;  // u8 kind, u8 children, u32 points, u64 place, u64 bytes
constexpr unsigned proxy = 2;
constexpr const char* hierarchyFile = "hierarchy.bin";

struct HierarchyChunk {
    std::string name;
    std::uint64_t at = 0, bytes = 0;
};

Expected<void> readChunk(const TreeFile& file, const HierarchyChunk& chunk, std::vector<PotreeNode>& nodes,
                         std::vector<HierarchyChunk>& chunks) {
    const auto [root, at, bytes] = chunk;
    const auto most = std::uint64_t(mostPotreeNodes) * entryBytes;
    if (bytes == 0 || bytes % entryBytes != 0 || at > file.bytes() || bytes > file.bytes() - at ||
        bytes > most)
        return fail(
            ErrorCode::Malformed,
            fmt::format(
                "{}: the chunk of the node {} is said to have {} bytes at byte {}; the file has {}, a node "
                "has {}",
                hierarchyFile, root, grouped(bytes), grouped(at), grouped(file.bytes()), entryBytes));
    std::vector<std::byte> content(bytes);
    if (auto ok = file.read(at, content); !ok) return ok;
    std::vector<std::string> names{root};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto entry = i * entryBytes;
        const std::string name = names[i];
        const auto wrong = [&](const std::string& reason) {
            return fail(ErrorCode::Malformed,
                        fmt::format("{}, byte {}: {}", hierarchyFile, grouped(at + entry), reason));
        };
        if (entry >= bytes) return wrong(fmt::format("the chunk of {} ends before its node {}", root, name));
        if (name.size() > longestNodeName || nodes.size() + names.size() + chunks.size() > mostPotreeNodes)
            return wrong("the octree is deeper or larger than any real one");
        const auto* data = content.data() + entry;
        const unsigned kind = loadLe<std::uint8_t>(data);
        const unsigned children = loadLe<std::uint8_t>(data + 1);
        const auto place = loadLe<std::uint64_t>(data + 6);
        const auto size = loadLe<std::uint64_t>(data + 14);
        if (kind > proxy)
            return wrong(fmt::format("the node {} is of kind {}; 0, 1 and 2 are known", name, kind));
        if (kind == proxy) {
            if (i == 0)
                return wrong(fmt::format("the chunk of {} starts with another reference: a circle", root));
            chunks.push_back({name, place, size});
            continue;
        }
        // Some inner nodes claim points although they have none; their bytes tell.
        if (size > 0) nodes.push_back({name, loadLe<std::uint32_t>(data + 2), place, size});
        for (char child = 0; child < 8; ++child)
            if ((children & (1U << child)) != 0) names.push_back(name + static_cast<char>('0' + child));
    }
    if (names.size() * entryBytes != bytes)
        return fail(ErrorCode::Malformed,
                    fmt::format("{}: the chunk of the node {} has {} bytes for {} nodes", hierarchyFile, root,
                                grouped(bytes), grouped(names.size())));
    return {};
}

}  // namespace

Expected<std::vector<PotreeNode>> readHierarchy2(const TreeFiles& files, std::uint64_t firstChunkBytes) {
    const auto file = files.open(hierarchyFile);
    if (!file) return passOn(file);
    std::vector<PotreeNode> nodes;
    std::set<std::uint64_t> seen;
    std::vector<HierarchyChunk> chunks{{"r", 0, firstChunkBytes}};
    // Chunks grow while they are read: a proxy in one is the root of another.
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        const HierarchyChunk chunk = chunks[i];
        if (!seen.insert(chunk.at).second)
            return fail(ErrorCode::Malformed,
                        fmt::format("{}, byte {}: two nodes (one is {}) share the chunk there: a circle",
                                    hierarchyFile, grouped(chunk.at), chunk.name));
        if (auto ok = readChunk(**file, chunk, nodes, chunks); !ok) return passOn(ok);
    }
    return nodes;
}

}  // namespace scancast::import_octree
