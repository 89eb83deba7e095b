// Cloud files for tests: an octree written as one, and files with lies in them whose checksums are right.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>

#include "files/random_reader.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"
#include "renderer/cloud/file/packed_index.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

/// Rows of one leaf: every byte depends on where it stands.
inline std::vector<std::byte> madeUpRows(std::uint32_t node, std::size_t rows, std::size_t bytes) {
    std::vector<std::byte> out(rows * bytes);
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = std::byte(i % bytes < 2 ? node : unsigned(256 * uniform(i, node)));
    return out;
}

/// What is known of a file's blocks, and what the file tells of itself.
struct FileParts {
    std::vector<StoredNode> nodes;
    std::vector<BlockPlace> planes;
    CloudFacts facts;
    std::vector<BlockPlace> photos;  ///< of facts.photos
};

/// Made up values of a companion, as madeUpRows() are of columns. Every third node has none.
inline std::vector<std::byte> madeUpCompanion(std::uint32_t node, std::size_t values,
                                              const ValuePlane& plane) {
    if (node % 3 == 2) return {};
    return madeUpRows(node + 1000, values, bytesOf(plane.type));
}

/// Appends a node's made up values beside its samples.
inline Expected<void> appendPlanes(CloudFileWriter& writer, const CloudFacts& facts, const Node& node,
                                   std::uint32_t index, FileParts& parts) {
    std::vector<ColumnType> types;
    for (const KeptColumn& kept : facts.columns) types.push_back(kept.column.type);
    const auto columns = placesInRow(types);
    const auto rows = madeUpRows(index, node.sampleCount, columns.empty() ? 0 : columns[0].rowBytes);
    const auto append = [&](std::span<const std::byte> values, std::size_t bytes) -> Expected<void> {
        const auto place = writer.append(encodeRows(values, bytes));
        if (!place) return passOn(place);
        parts.planes.push_back(*place);
        return {};
    };
    for (const PlaceInRow& column : columns)
        if (auto ok =
                append(node.isLeaf() ? takeColumn(rows, column) : std::vector<std::byte>(), column.bytes);
            !ok)
            return ok;
    for (const ValuePlane& plane : facts.companions)
        if (auto ok = append(madeUpCompanion(index, node.sampleCount, plane), bytesOf(plane.type)); !ok)
            return ok;
    return {};
}

/// Appends every node's samples, and made up values where facts have planes. No assertion in it, so that a child
/// process may use it.
inline Expected<FileParts> appendAll(CloudFileWriter& writer, const Octree& octree, const CloudFacts& facts) {
    FileParts parts{.nodes = {}, .planes = {}, .facts = facts, .photos = {}};
    for (std::uint32_t i = 0; i < octree.nodes().size(); ++i) {
        const auto run = octree.run(i);
        if (!run) return passOn(run);
        const auto place = writer.append(encodeSamples(run->samples));
        if (!place) return passOn(place);
        parts.nodes.push_back({octree.node(i), *place});
        if (auto ok = appendPlanes(writer, facts, octree.node(i), i, parts); !ok) return passOn(ok);
    }
    return parts;
}

inline Expected<void> finish(CloudFileWriter& writer, const FileParts& parts) {
    return writer.finish(parts.facts, parts.nodes, parts.planes);
}

inline Expected<void> writeCloudFile(const std::filesystem::path& path, const Octree& octree,
                                     const CloudFacts& facts) {
    auto writer = CloudFileWriter::create(path);
    if (!writer) return passOn(writer);
    const auto parts = appendAll(**writer, octree, facts);
    if (!parts) return passOn(parts);
    return finish(**writer, *parts);
}

inline std::vector<std::byte> fileBytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

inline Expected<std::shared_ptr<const CloudFile>> openBytes(std::span<const std::byte> bytes) {
    return CloudFile::open(readerOf(bytes), "memory.scan");
}

/// All places of planes, node by node.
inline std::vector<BlockPlace> planePlaces(const CloudFile& file) {
    std::vector<BlockPlace> places;
    for (std::uint32_t i = 0; i < file.nodes().size(); ++i)
        for (std::size_t p = 0; p < file.planes().size(); ++p) places.push_back(file.planePlace(i, p));
    return places;
}

/// A file of blocks and of what is said of them, whose lengths and checksums are right. `blocks` begins with room
/// for the header; indices as they are stored.
inline std::vector<std::byte> assembled(std::span<const std::byte> blocks, CloudFileHeader header,
                                        std::span<const std::byte> index, std::span<const std::byte> planes,
                                        std::span<const std::byte> facts) {
    std::vector<std::byte> out(blocks.begin(), blocks.end());
    const auto append = [&](std::span<const std::byte> bytes) {
        const FilePart part{.offset = out.size(), .bytes = bytes.size(), .checksum = checksumOf(bytes)};
        out.insert(out.end(), bytes.begin(), bytes.end());
        return part;
    };
    header.index = append(index);
    header.planes = append(planes);
    header.facts = append(facts);
    header.fileBytes = out.size();
    const auto start = encodeHeader(header);
    std::copy(start.begin(), start.end(), out.begin());
    return out;
}

/// The same of residuals, which are packed.
inline std::vector<std::byte> packedFile(std::span<const std::byte> blocks, std::span<const std::byte> nodes,
                                         std::span<const std::byte> planes,
                                         std::span<const std::byte> facts) {
    CloudFileHeader header;
    header.nodes = std::uint32_t(nodes.size() / nodeRecordBytes);
    return assembled(blocks, header, packRecords(nodes, packedNodes), packRecords(planes, packedPlaces),
                     facts);
}

/// What there is to lie about in a file.
inline FileParts partsOf(std::span<const std::byte> file) {
    const auto opened = openBytes(file).value();
    return {.nodes = {opened->nodes().begin(), opened->nodes().end()},
            .planes = planePlaces(*opened),
            .facts = opened->facts(),
            .photos = {opened->photoPlaces().begin(), opened->photoPlaces().end()}};
}

/// The same file with other nodes, planes and facts: everything is consistent but what the change made wrong.
inline std::vector<std::byte> forged(std::span<const std::byte> file,
                                     const std::function<void(FileParts&)>& change) {
    const CloudFileHeader header = parseHeader(file.first(cloudHeaderBytes), file.size()).value();
    FileParts parts = partsOf(file);
    change(parts);
    const std::string json = printFacts(parts.facts, "forger", parts.photos).value();
    return packedFile(file.first(header.index.offset), residualsOf(parts.nodes),
                      residualsOf(parts.planes, parts.nodes, planesOf(parts.facts).size()),
                      std::as_bytes(std::span(json)));
}

}  // namespace scancast::test
