// Any bytes as a cloud file: an error with words, or nodes that keep the promises of the page; never a crash.
// An input is tried as it is, as changes to a sound file, and as that file's blocks, records and facts - each
// time with the checksums made right, or they would keep everything else from being reached.
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "renderer/cloud/file/block_codec.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"
#include "renderer/cloud/file/random_reader.hpp"

namespace {

using namespace scancast;
using Bytes = std::vector<std::byte>;

void tryFile(std::span<const std::byte> bytes) {
    const auto file = CloudFile::open(readerOf(bytes), "fuzz.scan");
    if (!file) {
        if (file.error().message.empty()) std::abort();
        return;
    }
    const auto nodes = (*file)->nodes();
    std::uint64_t samplesBefore = 0;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        const Node& n = nodes[i].node;
        if (n.firstSample != samplesBefore || !(n.spacing > 0) || !std::isfinite(n.radius)) std::abort();
        if (!n.isLeaf() && (n.firstChild <= i || n.firstChild + std::uint64_t(n.childCount) > nodes.size()))
            std::abort();
        samplesBefore += n.sampleCount;
        if (const auto samples = (*file)->samples(i); samples && samples->size() != n.sampleCount)
            std::abort();
        (void)(*file)->rows(i);
    }
}

/// A file of header, blocks, records and facts whose checksums are right, those of the blocks included.
Bytes assemble(std::span<const std::byte> blocks, Bytes records, std::span<const std::byte> facts) {
    Bytes file(cloudHeaderBytes + blocks.size());
    std::copy(blocks.begin(), blocks.end(), file.begin() + cloudHeaderBytes);
    CloudFileHeader header;
    header.nodes = std::uint32_t(records.size() / nodeRecordBytes);
    for (std::size_t i = 0; i < header.nodes; ++i) {
        const auto record = std::span(records).subspan(i * nodeRecordBytes).first<nodeRecordBytes>();
        StoredNode node = decodeNode(record);
        for (BlockPlace* place : {&node.samples, &node.rows})
            if (place->offset <= file.size() && place->bytes <= file.size() - place->offset &&
                place->bytes > 0)
                place->checksum = checksumOf(std::span(file).subspan(place->offset, place->bytes));
        encodeNode(node, record);
    }
    header.index.offset = file.size();
    header.index.checksum = checksumOf(records);
    header.factsOffset = file.size() + records.size();
    header.factsBytes = facts.size();
    header.factsChecksum = checksumOf(facts);
    file.insert(file.end(), records.begin(), records.end());
    file.insert(file.end(), facts.begin(), facts.end());
    header.fileBytes = file.size();
    const auto start = encodeHeader(header);
    std::copy(start.begin(), start.end(), file.begin());
    return file;
}

/// A root with two leaves, as sound as can be: what mutations start from.
struct Sound {
    Bytes blocks, records;
    std::string facts;
};

Sound sound() {
    Sound s;
    CloudFacts cloud;
    cloud.points = 40;
    cloud.columns = {{{"gps_time", ColumnType::Float64, 1, 0, ""}, {0, 1}}};
    s.facts = printFacts(cloud, "fuzzer").value();
    std::uint64_t samplesBefore = 0;
    s.records.resize(3 * nodeRecordBytes);
    for (std::uint32_t i = 0; i < 3; ++i) {
        StoredNode stored{};
        Node& n = stored.node;
        n.step = n.boxMax = glm::dvec3(1);
        n.spacing = n.meanSpacing = 1;
        n.level = i > 0;
        n.parent = i > 0 ? 0 : noNode;
        n.childCount = i > 0 ? 0 : 2;
        n.firstChild = i > 0 ? noNode : 1;
        n.sampleCount = 20;
        n.points = i > 0 ? 20 : 40;
        n.firstSample = samplesBefore;
        samplesBefore += n.sampleCount;
        const std::vector<Sample> samples(n.sampleCount,
                                          Sample{std::uint16_t(i), 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
        const auto put = [&](const Bytes& block) {
            const BlockPlace place{cloudHeaderBytes + s.blocks.size(), std::uint32_t(block.size()), 0};
            s.blocks.insert(s.blocks.end(), block.begin(), block.end());
            return place;
        };
        stored.samples = put(encodeSamples(samples));
        if (i > 0) stored.rows = put(encodeRows(Bytes(20 * 8), 8));
        encodeNode(stored, std::span(s.records).subspan(i * nodeRecordBytes).first<nodeRecordBytes>());
    }
    return s;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Sound start = sound();
    static const bool good = [] {
        const auto file = assemble(start.blocks, start.records,
                                   std::as_bytes(std::span(start.facts.data(), start.facts.size())));
        return CloudFile::open(readerOf(file), "sound.scan").has_value();
    }();
    if (!good) std::abort();  // then nothing behind the checks would be reached
    const auto bytes = std::as_bytes(std::span(data, size));
    tryFile(bytes);

    // Each three bytes change one byte of what is sound: where (16 bits) and to what.
    Bytes records = start.records, blocks = start.blocks;
    std::string facts = start.facts;
    const std::size_t total = records.size() + blocks.size() + facts.size();
    for (std::size_t at = 0; at + 3 <= size && at < 48; at += 3) {
        std::size_t where = (data[at] | std::size_t(data[at + 1]) << 8) % total;
        if (where < records.size())
            records[where] = std::byte(data[at + 2]);
        else if ((where -= records.size()) < blocks.size())
            blocks[where] = std::byte(data[at + 2]);
        else
            facts[where - blocks.size()] = char(data[at + 2]);
    }
    tryFile(assemble(blocks, records, std::as_bytes(std::span(facts.data(), facts.size()))));
    // And the input itself as blocks, as records and as facts.
    tryFile(assemble(bytes, start.records, std::as_bytes(std::span(facts.data(), facts.size()))));
    Bytes own(bytes.begin(), bytes.begin() + std::ptrdiff_t(size / nodeRecordBytes * nodeRecordBytes));
    tryFile(assemble(start.blocks, own, std::as_bytes(std::span(facts.data(), facts.size()))));
    tryFile(assemble(start.blocks, start.records, bytes));
    return 0;
}
