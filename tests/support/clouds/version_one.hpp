// Cloud files of version 1, which nothing writes any more: made of the parts of a newer one, as CLOUD_FILE.md
// ("Version 1") has them.
#pragma once

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "files/bytes.hpp"
#include "protocol/json_text.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"

namespace scancast::test {

/// A header of version 1: without an index of planes, facts right behind the index.
inline std::array<std::byte, cloudHeaderBytes> versionOneHeader(CloudFileHeader header) {
    header.version = 1;
    header.planes = {};
    return encodeHeader(header);
}

/// A node's record: no confidence, but where its rows are.
inline void encodeVersionOneNode(const StoredNode& node, const BlockPlace& rows,
                                 std::span<std::byte, nodeRecordBytes> record) {
    encodeNode(node, record);
    record[142] = std::byte(0);
    storeLe(&record[184], rows.offset);
    storeLe(&record[192], rows.checksum);
    storeLe(&record[200], rows.bytes);
}

/// Facts without planes and photos.
inline std::string versionOneFacts(CloudFacts facts, std::string_view writtenBy) {
    facts.companions.clear();
    facts.photos.clear();
    auto json = parseJson(printFacts(facts, writtenBy).value()).value();
    json.erase("planes");
    return printJson(json);
}

/// The same cloud in version 1; companions get lost.
inline std::vector<std::byte> asVersionOne(const CloudFile& file) {
    std::vector<std::byte> out(cloudHeaderBytes), index(file.nodes().size() * nodeRecordBytes);
    const auto append = [&](std::span<const std::byte> bytes) {
        const BlockPlace place{out.size(), std::uint32_t(bytes.size()), checksumOf(bytes)};
        out.insert(out.end(), bytes.begin(), bytes.end());
        return bytes.empty() ? BlockPlace{} : place;
    };
    std::size_t rowBytes = 0;
    for (const KeptColumn& kept : file.facts().columns) rowBytes += bytesOf(kept.column.type);
    for (std::uint32_t i = 0; i < file.nodes().size(); ++i) {
        StoredNode stored = file.nodes()[i];
        stored.samples = append(encodeSamples(file.samples(i).value()));
        const BlockPlace rows = append(encodeRows(file.rows(i).value(), rowBytes));
        encodeVersionOneNode(stored, rows,
                             std::span(index).subspan(i * nodeRecordBytes).first<nodeRecordBytes>());
    }
    const std::string facts = versionOneFacts(file.facts(), file.writtenBy());
    const auto text = std::as_bytes(std::span(facts.data(), facts.size()));
    CloudFileHeader header;
    header.nodes = std::uint32_t(file.nodes().size());
    header.index = {.offset = out.size(), .bytes = index.size(), .checksum = checksumOf(index)};
    header.facts = {.offset = header.index.end(), .bytes = text.size(), .checksum = checksumOf(text)};
    header.fileBytes = header.facts.end();
    out.insert(out.end(), index.begin(), index.end());
    out.insert(out.end(), text.begin(), text.end());
    const auto start = versionOneHeader(header);
    std::copy(start.begin(), start.end(), out.begin());
    return out;
}

}  // namespace scancast::test
