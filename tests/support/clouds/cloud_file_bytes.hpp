// Cloud files for tests: an octree written as one, and files with lies in them whose checksums are right.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_codec.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"
#include "renderer/cloud/file/random_reader.hpp"
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

/// Appends every node's block, and made up rows where facts have columns. No assertion in it, so that a child
/// process may use it.
inline Expected<std::vector<StoredNode>> appendAll(CloudFileWriter& writer, const Octree& octree,
                                                   const CloudFacts& facts) {
    std::size_t bytes = 0;
    for (const KeptColumn& kept : facts.columns) bytes += bytesOf(kept.column.type);
    std::vector<StoredNode> nodes;
    for (std::uint32_t i = 0; i < octree.nodes().size(); ++i) {
        StoredNode stored{octree.node(i), {}, {}};
        const auto run = octree.run(i);
        if (!run) return passOn(run);
        const auto place = writer.append(encodeSamples(run->samples));
        if (!place) return passOn(place);
        stored.samples = *place;
        if (stored.node.isLeaf() && bytes > 0) {
            const auto rows = writer.append(encodeRows(madeUpRows(i, run->samples.size(), bytes), bytes));
            if (!rows) return passOn(rows);
            stored.rows = *rows;
        }
        nodes.push_back(stored);
    }
    return nodes;
}

inline Expected<void> writeCloudFile(const std::filesystem::path& path, const Octree& octree,
                                     const CloudFacts& facts) {
    auto writer = CloudFileWriter::create(path);
    if (!writer) return passOn(writer);
    const auto nodes = appendAll(**writer, octree, facts);
    if (!nodes) return passOn(nodes);
    return (*writer)->finish(facts, *nodes);
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

/// The same file with other nodes and facts: everything is consistent but what the change made wrong.
inline std::vector<std::byte> forged(
    std::span<const std::byte> file,
    const std::function<void(std::vector<StoredNode>&, CloudFacts&)>& change) {
    CloudFileHeader header = parseHeader(file.first(cloudHeaderBytes), file.size()).value();
    const auto original = openBytes(file).value();
    std::vector<StoredNode> nodes(original->nodes().begin(), original->nodes().end());
    CloudFacts facts = original->facts();
    change(nodes, facts);
    std::vector<std::byte> out(file.begin(), file.begin() + std::ptrdiff_t(header.index.offset));
    std::vector<std::byte> index(nodes.size() * nodeRecordBytes);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        encodeNode(nodes[i], std::span(index).subspan(i * nodeRecordBytes).first<nodeRecordBytes>());
    const std::string json = printFacts(facts, "forger").value();
    const auto text = std::as_bytes(std::span(json));
    out.insert(out.end(), index.begin(), index.end());
    out.insert(out.end(), text.begin(), text.end());
    header.nodes = std::uint32_t(nodes.size());
    header.index.checksum = checksumOf(index);
    header.factsOffset = header.index.offset + index.size();
    header.factsBytes = text.size();
    header.factsChecksum = checksumOf(text);
    header.fileBytes = out.size();
    const auto start = encodeHeader(header);
    std::copy(start.begin(), start.end(), out.begin());
    return out;
}

}  // namespace scancast::test
