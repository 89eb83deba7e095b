// Cloud files of version 2, which nothing writes any more: a newer one's blocks and facts, with indices as CLOUD_FILE.md
// ("Version 2") has them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/support/clouds/cloud_file_bytes.hpp"

namespace scancast::test {

/// The indices as they stand in a file.
inline std::vector<std::byte> nodeRecords(std::span<const StoredNode> nodes) {
    std::vector<std::byte> records(nodes.size() * nodeRecordBytes);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        encodeNode(nodes[i], std::span(records).subspan(i * nodeRecordBytes).first<nodeRecordBytes>());
    return records;
}

inline std::vector<std::byte> planeRecords(std::span<const BlockPlace> places) {
    std::vector<std::byte> records(places.size() * planeRecordBytes);
    for (std::size_t i = 0; i < places.size(); ++i)
        encodePlane(places[i], std::span(records).subspan(i * planeRecordBytes).first<planeRecordBytes>());
    return records;
}

/// `blocks` begins with room for the header.
inline std::vector<std::byte> versionTwoFile(std::span<const std::byte> blocks,
                                             std::span<const std::byte> nodes,
                                             std::span<const std::byte> planes,
                                             std::span<const std::byte> facts) {
    CloudFileHeader header;
    header.version = 2;
    header.nodes = std::uint32_t(nodes.size() / nodeRecordBytes);
    return assembled(blocks, header, nodes, planes, facts);
}

/// The same cloud in version 2, or one that differs as `change` says.
inline std::vector<std::byte> asVersionTwo(
    std::span<const std::byte> file, const std::function<void(FileParts&)>& change = [](FileParts&) {}) {
    const CloudFileHeader header = parseHeader(file.first(cloudHeaderBytes), file.size()).value();
    FileParts parts = partsOf(file);
    change(parts);
    const std::string json = printFacts(parts.facts, programName(), parts.photos).value();
    return versionTwoFile(file.first(header.index.offset), nodeRecords(parts.nodes),
                          planeRecords(parts.planes), std::as_bytes(std::span(json)));
}

}  // namespace scancast::test
