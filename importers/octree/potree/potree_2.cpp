// Potree 2: metadata.json, hierarchy.bin and octree.bin.
#include <fmt/format.h>

#include <algorithm>

#include "importers/octree/potree/brotli_node.hpp"
#include "importers/octree/potree/nodes_2.hpp"
#include "importers/octree/potree/potree_layout.hpp"
#include "importers/octree/potree/potree_octree.hpp"
#include "renderer/cloud/import/octree/json_values.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

using nlohmann::json;

constexpr const char* octreeFile = "octree.bin";
// A compressed node is in memory as a whole. Real ones have some ten thousand points.
constexpr std::uint64_t longestNode = std::uint64_t(96) << 20;
constexpr std::uint64_t brotliWindow = std::uint64_t(17) << 20;  // with what the library keeps besides

class Potree2 final : public Octree {
  public:
    Potree2(const TreeFiles& files, PotreeLayout layout, const Grid& grid, bool isBrotli, bool keep)
        : files_(files),
          layout_(std::move(layout)),
          decoder_(layout_.points, grid, keep),
          isBrotli_(isBrotli) {
        header_.gridStep = grid.scale;
        header_.gridOrigin = grid.offset;
        header_.attributes = layout_.points.attributes();
        if (keep) header_.columns = columnsOf(layout_.points.kept());
        mayHaveWideColors_ = layout_.points.hasWideColors();
        areSteps_ = decoder_.grid().has_value();
    }

    /// Takes the nodes over, each checked before anything is allocated for it.
    Expected<void> take(std::vector<PotreeNode> nodes) {
        const auto file = files_.open(octreeFile);
        if (!file) return passOn(file);
        // What is compressed has bytes even without points.
        if (isBrotli_) std::erase_if(nodes, [](const PotreeNode& node) { return node.points == 0; });
        for (const auto& node : nodes)
            if (auto ok = check(node, (*file)->bytes()); !ok) return ok;
        nodes_ = std::move(nodes);
        return {};
    }

    void describe(const json& metadata, const std::string& version, const std::string& encoding) {
        header_.format = fmt::format("Potree {}, {}", printableText(version, 20), encoding);
        const auto& box = valueAt(metadata, "boundingBox");
        header_.bounds = boundsOf(valueAt(box, "min"), valueAt(box, "max"));
        takeCrs(wordOf(valueAt(metadata, "projection")), header_);
        std::uint64_t held = 0;
        for (const auto& node : nodes_) held += node.points;
        takeDeclaredPoints("metadata.json", declaredPoints(metadata), held, header_, notes_);
    }

    std::size_t pieces() const override { return nodes_.size(); }

    std::uint64_t memoryOf(std::size_t piece) const override {
        const auto& node = nodes_[piece];
        const auto slices = slicesMemory(layout_.points.bytes(), node.points);
        return isBrotli_ ? slices + unpackedBytes(node) + node.bytes + brotliWindow : slices;
    }

    Expected<void> read(std::size_t piece, const Wanted& wanted, const TakeRecords& take) const override {
        const auto& node = nodes_[piece];
        const auto file = files_.open(octreeFile);
        if (!file) return passOn(file);
        if (isBrotli_) return readBrotli(**file, node, wanted, take);
        return readPlainRecords(**file, node.at, node.points, wanted, decoder_, take);
    }

  private:
    std::uint64_t unpackedBytes(const PotreeNode& node) const {
        return node.points * brotliPointBytes(layout_);
    }

    Expected<void> check(const PotreeNode& node, std::uint64_t fileBytes) const {
        if (node.at > fileBytes || node.bytes > fileBytes - node.at)
            return fail(ErrorCode::Truncated,
                        fmt::format("the node {} is said to end {} bytes behind byte {} of {}, which has {}",
                                    node.name, grouped(node.bytes), grouped(node.at), octreeFile,
                                    grouped(fileBytes)));
        const std::uint64_t plain = std::uint64_t(node.points) * layout_.points.bytes();
        if (!isBrotli_ && node.bytes != plain)
            return fail(ErrorCode::Malformed,
                        fmt::format("the node {} has {} bytes; its {} points need {}", node.name,
                                    grouped(node.bytes), grouped(node.points), grouped(plain)));
        const auto whole = unpackedBytes(node) + node.bytes;
        if (isBrotli_ && whole > longestNode)
            return fail(ErrorCode::ResourceLimit,
                        fmt::format("the node {} has {} bytes; compressed nodes of up to {} are read",
                                    node.name, grouped(whole), grouped(longestNode)));
        return {};
    }

    Expected<void> readBrotli(const TreeFile& file, const PotreeNode& node, const Wanted& wanted,
                              const TakeRecords& take) const {
        std::vector<std::byte> bytes(node.bytes);
        if (auto ok = file.read(node.at, bytes); !ok) return ok;
        const auto unpacked = unpackBrotli(bytes, unpackedBytes(node), "the node " + node.name);
        if (!unpacked) return passOn(unpacked);
        const auto end = std::min<std::uint64_t>(node.points, wanted.points);
        std::vector<std::byte> records;
        for (std::uint64_t done = 0; done < end;) {
            const auto count = std::min<std::uint64_t>(sliceRecords(decoder_.recordBytes()), end - done);
            records.resize(count * decoder_.recordBytes());
            brotliRecords(layout_, *unpacked, node.points, done, records);
            const auto more = take(decoder_, records);
            if (!more) return passOn(more);
            if (!*more) return {};
            done += count;
        }
        return {};
    }

    const TreeFiles& files_;
    const PotreeLayout layout_;
    const FieldDecoder decoder_;
    const bool isBrotli_;
    std::vector<PotreeNode> nodes_;
};

}  // namespace

Expected<std::unique_ptr<Octree>> openPotree2(const TreeFiles& files, bool keepAttributes) {
    const auto metadata = readJsonObject(files, "metadata.json");
    if (!metadata) return passOn(metadata);
    const auto version = wordOf(valueAt(*metadata, "version"));
    if (!version.starts_with("2."))
        return fail(ErrorCode::Unsupported,
                    fmt::format("metadata.json has version {}; 2.0 and 2.1 are read", quotedText(version)));
    const auto& told = valueAt(*metadata, "encoding");
    const auto encoding = told.is_null() ? std::string("DEFAULT") : wordOf(told);
    // What stands in "encoding" of files that are not compressed depends on the converter's release.
    if (encoding != "DEFAULT" && encoding != "UNCOMPRESSED" && encoding != "BROTLI")
        return fail(
            ErrorCode::Unsupported,
            fmt::format("the encoding {} is not known here; DEFAULT and BROTLI are", quotedText(encoding)));
    const auto scale = vectorOf(valueAt(*metadata, "scale"), "\"scale\"");
    if (!scale) return passOn(scale);
    const auto offset = vectorOf(valueAt(*metadata, "offset"), "\"offset\"");
    if (!offset) return passOn(offset);
    if (auto ok = checkGrid(*scale, *offset, "metadata.json"); !ok) return passOn(ok);
    auto layout = layOutPotree(valueAt(*metadata, "attributes"), false);
    if (!layout) return passOn(layout);
    const auto firstChunk = countOf(valueAt(valueAt(*metadata, "hierarchy"), "firstChunkSize"),
                                    "\"hierarchy.firstChunkSize\"", std::uint64_t(1) << 53);
    if (!firstChunk) return passOn(firstChunk);
    auto nodes = readHierarchy2(files, *firstChunk);
    if (!nodes) return passOn(nodes);
    auto octree = std::make_unique<Potree2>(files, std::move(*layout), Grid{*scale, *offset},
                                            encoding == "BROTLI", keepAttributes);
    if (auto ok = octree->take(std::move(*nodes)); !ok) return passOn(ok);
    octree->describe(*metadata, version, encoding);
    if (octree->pieces() == 0) return fail(ErrorCode::Empty, "it is a Potree octree without points");
    return octree;
}

}  // namespace scancast::import_octree
