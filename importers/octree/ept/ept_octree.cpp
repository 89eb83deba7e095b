#include "importers/octree/ept/ept_octree.hpp"

#include <fmt/format.h>

#include "importers/octree/ept/ept_hierarchy.hpp"
#include "importers/octree/ept/zstd_records.hpp"
#include "importers/octree/tree/las_tiles.hpp"
#include "renderer/cloud/import/octree/ept_description.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

class EptOctree final : public Octree {
  public:
    EptOctree(const TreeFiles& files, EptDescription ept, std::deque<EptNode> nodes, bool keep)
        : files_(files),
          ept_(std::move(ept)),
          nodes_(std::move(nodes)),
          keep_(keep),
          decoder_(ept_.layout, {}, keep),
          las_(files, keep) {}

    /// Looks at all tiles.
    Expected<void> prepare() {
        std::uint64_t held = 0;
        for (const auto& node : nodes_) {
            if (auto ok = checkTile(node); !ok) return ok;
            held += node.points;
        }
        if (held == 0) return fail(ErrorCode::Empty, "it is an EPT folder without points");
        header_ = ept_.header;
        takeDeclaredPoints("ept.json", ept_.points, held, header_, notes_);
        if (ept_.data == EptData::Laszip) {
            las_.describe(header_);
            mayHaveWideColors_ = las_.haveColors();
            areSteps_ = las_.haveOneGrid();
        } else {
            if (keep_) header_.columns = columnsOf(ept_.layout.kept());
            mayHaveWideColors_ = ept_.layout.hasWideColors();
            areSteps_ = decoder_.grid().has_value();
        }
        return {};
    }

    std::size_t pieces() const override { return nodes_.size(); }

    std::uint64_t memoryOf(std::size_t piece) const override {
        if (ept_.data == EptData::Laszip) return las_.memoryOf(piece);
        const std::uint64_t points = nodes_[piece].points;
        const std::uint64_t slices = slicesMemory(ept_.layout.bytes(), points);
        return slices + (ept_.data == EptData::Zstandard ? zstdMemory(points * ept_.layout.bytes()) : 0);
    }

    Expected<void> read(std::size_t piece, const Wanted& wanted, const TakeRecords& take) const override {
        if (ept_.data == EptData::Laszip) return las_.read(piece, wanted, take);
        const auto& node = nodes_[piece];
        const auto tile = tileOf(node);
        const auto file = files_.open(tile);
        if (!file) return passOn(file);
        if (ept_.data == EptData::Binary)
            return readPlainRecords(**file, 0, node.points, wanted, decoder_, take);
        return readZstdRecords(**file, "its file " + tile, node.points, wanted, decoder_, take);
    }

  private:
    std::string tileOf(const EptNode& node) const {
        return fmt::format("ept-data/{}.{}", text(node.key), extension(ept_.data));
    }

    Expected<void> checkTile(const EptNode& node) {
        const auto tile = tileOf(node);
        if (ept_.data == EptData::Laszip) {
            const auto points = las_.add(tile);
            if (!points) return passOn(points);
            if (*points == node.points) return {};
            return fail(ErrorCode::Malformed,
                        fmt::format("its file {} holds {} points; its hierarchy says {}", tile,
                                    grouped(*points), grouped(node.points)));
        }
        const auto file = files_.open(tile);
        if (!file) return passOn(file);
        const std::uint64_t wanted = node.points * ept_.layout.bytes(), found = (*file)->bytes();
        if (ept_.data != EptData::Binary || found == wanted) return {};
        return fail(found < wanted ? ErrorCode::Truncated : ErrorCode::Malformed,
                    fmt::format("its file {} has {} bytes; its {} points of {} bytes need {}", tile,
                                grouped(found), grouped(node.points), ept_.layout.bytes(), grouped(wanted)));
    }

    const TreeFiles& files_;
    const EptDescription ept_;
    const std::deque<EptNode> nodes_;
    const bool keep_;
    const FieldDecoder decoder_;
    LasTiles las_;
};

}  // namespace

Expected<std::unique_ptr<Octree>> openEpt(const TreeFiles& files, bool keepAttributes) {
    const auto json = readJsonObject(files, "ept.json");
    if (!json) return passOn(json);
    auto ept = parseEptDescription(*json);
    if (!ept) return passOn(ept);
    auto nodes = readEptHierarchy(files);
    if (!nodes) return passOn(nodes);
    auto octree = std::make_unique<EptOctree>(files, std::move(*ept), std::move(*nodes), keepAttributes);
    if (auto ok = octree->prepare(); !ok) return passOn(ok);
    return octree;
}

}  // namespace scancast::import_octree
