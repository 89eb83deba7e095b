// Any bytes as a cloud file: an error with words, or nodes that keep the promises of the page; never a crash.
// An input is tried as it is, as changes to a sound file, and as that file's blocks, indices and facts - each
// time with the checksums made right, or they would keep everything else from being reached. Changes to records are tried
// in every version, and changes to what packed indices are stored as.
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "files/random_reader.hpp"
#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/export/export_writer.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"
#include "renderer/cloud/file/packed_index.hpp"
#include "tests/support/clouds/version_one.hpp"

namespace {

using namespace scancast;
using Bytes = std::vector<std::byte>;

void tryFile(std::span<const std::byte> bytes) {
    const auto file = CloudFile::open(readerOf(bytes), "fuzz.scan");
    if (!file) {
        if (file.error().message.empty()) std::abort();
        return;
    }
    for (const Photo& photo : (*file)->facts().photos)
        if (const auto all = photo.data->read(); all && all->size() != photo.bytes) std::abort();
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
        for (std::size_t p = 0; p < (*file)->planes().size(); ++p) {
            const auto values = (*file)->plane(i, p);
            if (values && !values->empty() &&
                values->size() != n.sampleCount * bytesOf((*file)->planes()[p].type))
                std::abort();
        }
    }
}

/// Out again, in every format: an error with words, or written; never a crash.
void tryExport(std::span<const std::byte> bytes) {
    const auto file = CloudFile::open(readerOf(bytes), "fuzz.scan");
    if (!file) return;
    using Create =
        Expected<std::unique_ptr<ExportWriter>> (*)(OutputFile, const ScanHeader&, const PointSurvey&);
    const Create text = [](OutputFile output, const ScanHeader& header, const PointSurvey&) {
        return createTextExport(std::move(output), header, ',');
    };
    for (const Create create : {Create(&createLasExport), Create(&createPlyExport), text}) {
        const auto source = cloudPoints(*file);
        auto output = OutputFile::create("/dev/null");
        if (!output) std::abort();
        const auto writer = create(std::move(*output), source->header(), {});
        if (!writer) continue;
        PointSurvey survey;
        PointBatch batch;
        for (;;) {
            const auto more = source->read(batch);
            if (!more && more.error().message.empty()) std::abort();
            if (!more || !*more) break;
            survey.add(batch, source->header());
            if (!(*writer)->write(batch)) std::abort();
        }
        (void)(*writer)->finish(survey);
    }
}

/// What a file is made of.
struct Parts {
    Bytes blocks, nodes, planes;
    std::string facts;
};

constexpr std::size_t planesOfSound = 2;

/// What is there, and all of it within `file`, gets its checksum.
void makeRight(BlockPlace& place, std::span<const std::byte> file) {
    if (place.bytes > 0 && place.offset <= file.size() && place.bytes <= file.size() - place.offset)
        place.checksum = checksumOf(file.subspan(place.offset, place.bytes));
}

/// Header and blocks, then the parts; `header` learns where they are.
Bytes assemble(const Parts& parts, CloudFileHeader& header) {
    Bytes file(cloudHeaderBytes + parts.blocks.size());
    std::copy(parts.blocks.begin(), parts.blocks.end(), file.begin() + cloudHeaderBytes);
    const auto append = [&](std::span<const std::byte> bytes) {
        const FilePart part{.offset = file.size(), .bytes = bytes.size(), .checksum = checksumOf(bytes)};
        file.insert(file.end(), bytes.begin(), bytes.end());
        return part;
    };
    header.index = append(parts.nodes);
    header.planes = append(parts.planes);
    header.facts = append(std::as_bytes(std::span(parts.facts.data(), parts.facts.size())));
    header.fileBytes = file.size();
    return file;
}

/// The checksums of the blocks that records tell of.
void makeRight(Parts& parts) {
    Bytes blocks(cloudHeaderBytes);
    blocks.insert(blocks.end(), parts.blocks.begin(), parts.blocks.end());
    for (std::size_t at = 0; at + nodeRecordBytes <= parts.nodes.size(); at += nodeRecordBytes) {
        const auto record = std::span(parts.nodes).subspan(at).first<nodeRecordBytes>();
        BlockPlace samples = decodeNode(record).samples;
        makeRight(samples, blocks);
        storeLe(&record[packedNodes.checksumOffset], samples.checksum);
    }
    for (std::size_t at = 0; at + planeRecordBytes <= parts.planes.size(); at += planeRecordBytes) {
        const auto record = std::span(parts.planes).subspan(at).first<planeRecordBytes>();
        BlockPlace place = decodePlane(record);
        makeRight(place, blocks);
        storeLe(&record[packedPlaces.checksumOffset], place.checksum);
    }
}

/// Parts as they are stored, with a header that is right.
Bytes stored(const Parts& parts, std::uint32_t version, std::size_t nodes) {
    CloudFileHeader header;
    Bytes file = assemble(parts, header);
    header.version = version;
    header.nodes = std::uint32_t(nodes);
    const auto start = encodeHeader(header);
    std::copy(start.begin(), start.end(), file.begin());
    return file;
}

/// A file whose checksums are right, those of the blocks included.
Bytes versionTwo(Parts parts) {
    makeRight(parts);
    return stored(parts, 2, parts.nodes.size() / nodeRecordBytes);
}

/// Records of nodes and planes, as they are, packed.
void pack(Parts& parts) {
    std::vector<StoredNode> nodes;
    ExpectedNodes expectedNodes;
    for (std::size_t at = 0; at + nodeRecordBytes <= parts.nodes.size(); at += nodeRecordBytes) {
        const auto record = std::span(parts.nodes).subspan(at).first<nodeRecordBytes>();
        std::array<std::byte, nodeRecordBytes> known;
        std::copy(record.begin(), record.end(), known.begin());
        expectedNodes.apply(nodes, known, record);
        nodes.push_back(decodeNode(known));
    }
    ExpectedPlaces expectedPlaces(nodes, planesOfSound);
    for (std::size_t at = 0; at + planeRecordBytes <= parts.planes.size(); at += planeRecordBytes) {
        const auto record = std::span(parts.planes).subspan(at).first<planeRecordBytes>();
        std::array<std::byte, planeRecordBytes> known;
        std::copy(record.begin(), record.end(), known.begin());
        expectedPlaces.apply(known, record);
    }
    parts.nodes = packRecords(parts.nodes, packedNodes);
    parts.planes = packRecords(parts.planes, packedPlaces);
}

Bytes versionThree(Parts parts) {
    makeRight(parts);
    const std::size_t nodes = parts.nodes.size() / nodeRecordBytes;
    pack(parts);
    return stored(parts, 3, nodes);
}

/// The same in version 1: what is the column's place in version 2 is that of the rows.
Bytes versionOne(Parts parts) {
    Bytes blocks(cloudHeaderBytes);
    blocks.insert(blocks.end(), parts.blocks.begin(), parts.blocks.end());
    for (std::size_t i = 0; (i + 1) * nodeRecordBytes <= parts.nodes.size(); ++i) {
        const auto record = std::span(parts.nodes).subspan(i * nodeRecordBytes).first<nodeRecordBytes>();
        StoredNode node = decodeNode(record);
        makeRight(node.samples, blocks);
        BlockPlace rows;
        // The first plane of a node is a column.
        if (const std::size_t at = planesOfSound * i * planeRecordBytes;
            at + planeRecordBytes <= parts.planes.size())
            rows = decodePlane(std::span(parts.planes).subspan(at).first<planeRecordBytes>());
        makeRight(rows, blocks);
        test::encodeVersionOneNode(node, rows, record);
    }
    parts.planes.clear();
    CloudFileHeader header;
    Bytes file = assemble(parts, header);
    header.nodes = std::uint32_t(parts.nodes.size() / nodeRecordBytes);
    const auto start = test::versionOneHeader(header);
    std::copy(start.begin(), start.end(), file.begin());
    return file;
}

Node soundNode(std::uint32_t i) {
    Node n{};
    n.step = n.boxMax = glm::dvec3(1);
    n.spacing = n.meanSpacing = 1;
    n.level = i > 0;
    n.parent = i > 0 ? 0 : noNode;
    n.childCount = i > 0 ? 0 : 2;
    n.firstChild = i > 0 ? noNode : 1;
    n.sampleCount = 20;
    n.points = i > 0 ? 20 : 40;
    n.firstSample = 20 * i;
    return n;
}

/// A root with two leaves, a column and the curvature, as sound as can be: what mutations start from.
Parts sound() {
    Parts s;
    CloudFacts cloud;
    cloud.points = 40;
    cloud.columns = {{{"gps_time", ColumnType::Float64, 1, 0, ""}, {0, 1}}};
    cloud.companions = {curvaturePlane()};
    cloud.stations = {{.name = "tower"}};
    cloud.photos = {{.name = "nave", .station = 0, .bytes = 16}};
    s.facts = printFacts(cloud, "fuzzer", std::vector<BlockPlace>{{cloudHeaderBytes, 16, 0}}).value();
    const auto put = [&](const Bytes& block) {
        const BlockPlace place{cloudHeaderBytes + s.blocks.size(), std::uint32_t(block.size()), 0};
        s.blocks.insert(s.blocks.end(), block.begin(), block.end());
        return block.empty() ? BlockPlace{} : place;
    };
    s.nodes.resize(3 * nodeRecordBytes);
    s.planes.resize(3 * planesOfSound * planeRecordBytes);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const StoredNode stored{soundNode(i),
                                put(encodeSamples(std::vector<Sample>(
                                    20, Sample{std::uint16_t(i), 2, 3, 4, 5, 6, 7, 8, 9, 10, 11})))};
        encodeNode(stored, std::span(s.nodes).subspan(i * nodeRecordBytes).first<nodeRecordBytes>());
        const BlockPlace column = i > 0 ? put(encodeRows(Bytes(20 * 8), 8)) : BlockPlace{};
        const BlockPlace companion = put(encodeRows(Bytes(20 * 4, std::byte(i)), 4));
        const auto records = std::span(s.planes).subspan(planesOfSound * i * planeRecordBytes);
        encodePlane(column, records.first<planeRecordBytes>());
        encodePlane(companion, records.subspan(planeRecordBytes).first<planeRecordBytes>());
    }
    return s;
}

/// Each three bytes change one byte of what is sound: where (16 bits) and to what.
Parts changed(Parts parts, const std::uint8_t* data, std::size_t size) {
    const auto set = [&](std::size_t where, std::uint8_t to) {
        for (Bytes* part : {&parts.nodes, &parts.planes, &parts.blocks}) {
            if (where < part->size()) return void((*part)[where] = std::byte(to));
            where -= part->size();
        }
        parts.facts[where] = char(to);
    };
    const std::size_t total =
        parts.nodes.size() + parts.planes.size() + parts.blocks.size() + parts.facts.size();
    for (std::size_t at = 0; at + 3 <= size && at < 48; at += 3)
        set((data[at] | std::size_t(data[at + 1]) << 8) % total, data[at + 2]);
    return parts;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Parts start = sound();
    static const Bytes three = versionThree(start), two = versionTwo(start), one = versionOne(start);
    static const bool good = CloudFile::open(readerOf(three), "three.scan") &&
                             CloudFile::open(readerOf(two), "two.scan") &&
                             CloudFile::open(readerOf(one), "one.scan");
    if (!good) std::abort();  // then nothing behind the checks would be reached
    const auto bytes = std::as_bytes(std::span(data, size));
    tryFile(bytes);

    const Parts mutant = changed(start, data, size);
    tryFile(versionThree(mutant));
    tryExport(versionThree(mutant));
    tryFile(versionTwo(mutant));
    tryFile(versionOne(mutant));
    // What packed indices are stored as: changed, and said to be of as many nodes as the input likes.
    Parts packed = start;
    makeRight(packed);
    pack(packed);
    const Parts torn = changed(packed, data, size);
    tryFile(stored(torn, 3, 3));
    if (size > 0) tryFile(stored(torn, 3, data[0]));
    // And the input itself as blocks, as nodes, as planes and as facts.
    const auto whole = [&](std::size_t record) {
        return Bytes(bytes.begin(), bytes.begin() + std::ptrdiff_t(size / record * record));
    };
    Parts own = start;
    own.facts = mutant.facts, own.blocks = whole(1);
    tryFile(versionThree(own));
    own = start, own.facts = mutant.facts, own.nodes = whole(nodeRecordBytes);
    tryFile(versionThree(own));
    own = start, own.facts = mutant.facts, own.planes = whole(planeRecordBytes);
    tryFile(versionThree(own));
    own = packed, own.nodes = whole(1);
    tryFile(stored(own, 3, size / leastPackedBytes));
    own = packed, own.planes = whole(1);
    tryFile(stored(own, 3, 3));
    own = start, own.facts.assign(reinterpret_cast<const char*>(data), size);
    tryFile(versionThree(own));
    return 0;
}
