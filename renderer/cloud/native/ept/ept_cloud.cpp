#include "renderer/cloud/native/ept/ept_cloud.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "protocol/text/grouped.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/las/las_vlrs.hpp"
#include "renderer/cloud/import/octree/ept_description.hpp"
#include "renderer/cloud/native/ept/ept_tree.hpp"
#include "renderer/cloud/native/upper_levels.hpp"
#include "threads/guarded.hpp"

namespace scancast {

namespace {

using import_octree::EptData, import_octree::EptDescription;
using TileBytes = std::vector<std::byte>;

constexpr std::uint64_t longestDescription = 1 << 20;
// A tile of LAZ has a head, and its records are no longer than this, compressed; most have some 8 bytes a point.
constexpr std::uint64_t mostTileHead = 1 << 20, mostLazBytesPerPoint = 72;
// Of positions that are floating-point numbers: a cube has so many steps that samples, of 16 bits, are coarser.
constexpr double stepsInHalfCube = 0x1p28;
constexpr double sameSide = 1e-6;
constexpr std::size_t atTileFormat = 104;
constexpr std::uint8_t tileFormatBits = 0x3f;

Expected<VoxelCube> cubeOf(const EptDescription& ept) {
    const auto wrong = [] {
        return fail(ErrorCode::Malformed, "ept.json: its bounds are no cube: six finite numbers");
    };
    if (!ept.cube) return wrong();
    const auto& [low, high] = *ept.cube;
    const glm::dvec3 side = high - low;
    const double longest = std::max({side.x, side.y, side.z});
    if (!(longest > 0) || !std::isfinite(longest) || !std::isfinite(low.x + low.y + low.z)) return wrong();
    for (int a = 0; a < 3; ++a)
        if (!(longest - side[a] <= sameSide * longest)) return wrong();
    return VoxelCube{low + 0.5 * side, 0.5 * longest};
}

/// For whoever reads LAS, packed records are none.
Expected<LasHeader> headOfTile(const TileBytes& tile) {
    TileBytes start(tile.begin(), tile.begin() + std::ptrdiff_t(std::min(tile.size(), lasHeaderBytes)));
    if (start.size() > atTileFormat)
        start[atTileFormat] = std::byte(std::to_integer<std::uint8_t>(start[atTileFormat]) & tileFormatBits);
    return parseLasHeader(start, {});
}

class EptVoxels final : public VoxelSource {
  public:
    EptVoxels(std::shared_ptr<const FolderReader> files, std::shared_ptr<ChunkDecoders> decoders)
        : files_(std::move(files)), decoders_(std::move(decoders)) {}

    Expected<void> open(std::uint64_t upperPoints) {
        auto ept = describe();
        if (!ept) return passOn(std::move(ept));
        auto tree = readEptTree(*files_);
        if (!tree) return passOn(std::move(tree));
        scan_.tree = std::move(*tree);
        scan_.digest = XXH3_64bits_withSeed(name(data_).data(), name(data_).size(), scan_.digest);
        if (ept->points && *ept->points != scan_.tree.points)
            scan_.notes.push_back(fmt::format("ept.json promises {} points, and its octree has {}",
                                              grouped(*ept->points), grouped(scan_.tree.points)));
        scan_.header.points = scan_.tree.points;
        shape_.owner = newSource();
        if (data_ == EptData::Laszip) return openLaz(upperPoints);
        layout_ = std::move(ept->layout);
        return openRecords();
    }

    const NativeScan& scan() const override { return scan_; }
    void expect(std::uint32_t voxel) const override { files_->expect(tileOf(voxel), mostBytes(voxel)); }

    Expected<std::vector<std::byte>> records(std::uint32_t voxel) const override {
        const std::string name = tileOf(voxel);
        const std::uint64_t points = scan_.tree.voxels[voxel].points;
        if (points * shape_.recordBytes > chunk_messages::mostRecordBytes)
            return fail(ErrorCode::ResourceLimit,
                        fmt::format("its {} points of {} bytes are too many to be shown as they are{}",
                                    grouped(points), shape_.recordBytes, ingestInstead));
        // What came over a network may be sound the second time.
        for (int tries = 2;; --tries) {
            const auto tile = files_->read(name, mostBytes(voxel));
            if (!tile) return passOn(tile);
            auto records = unpacked(std::uint32_t(points), *tile);
            if (records) return records;
            if (tries == 1 || !files_->forget(name))
                return fail(records.error().code, "its file " + name + ": " + records.error().message);
        }
    }
    std::uint64_t bytes() const override { return files_->bytes(); }
    bool isRemote() const override { return files_->isRemote(); }
    bool isAway() const override { return files_->isAway(); }

  private:
    std::string tileOf(std::uint32_t voxel) const {
        return fmt::format("ept-data/{}.{}", text(scan_.tree.voxels[voxel].key), extension(data_));
    }

    /// Nothing longer is read.
    std::uint64_t mostBytes(std::uint32_t voxel) const {
        const std::uint64_t points = scan_.tree.voxels[voxel].points;
        if (data_ == EptData::Laszip) return mostTileHead + points * mostLazBytesPerPoint;
        return mostTileHead + std::min(points * shape_.recordBytes, chunk_messages::mostRecordBytes);
    }

    Expected<EptDescription> describe() {
        const auto bytes = files_->read(eptDescriptionName, longestDescription);
        if (!bytes) return passOn(bytes);
        // Whatever it says, this is asked for next.
        files_->expect("ept-hierarchy/0-0-0-0.json", longestEptPage);
        const auto json = import_octree::parseJsonObject(*bytes, eptDescriptionName);
        if (!json) return passOn(json);
        auto ept = import_octree::parseEptDescription(*json);
        if (!ept) return ept;
        const auto cube = cubeOf(*ept);
        if (!cube) return passOn(cube);
        data_ = ept->data;
        scan_.cube = *cube;
        scan_.header = ept->header;
        scan_.header.columns.clear();
        scan_.digest = XXH3_64bits(bytes->data(), bytes->size());
        return ept;
    }

    /// What the records of all tiles are is what those of one say, which the others are held against.
    Expected<void> openLaz(std::uint64_t upperPoints) {
        const auto upper = upperVoxels(scan_.tree, upperPoints);
        for (const std::uint32_t voxel : upper) expect(voxel);
        const auto tile = takeHead(upper.front());
        if (!tile) return passOn(tile);
        shape_.packing = chunk_messages::Packing::LazFile;
        shape_.pointFormat = std::uint32_t(las_.pointFormat);
        shape_.recordBytes = las_.recordBytes;
        const ScanHeader theirs = scanHeader(las_);
        scan_.header.attributes = theirs.attributes;
        scan_.header.gridStep = theirs.gridStep;
        scan_.header.gridOrigin = theirs.gridOrigin;
        takeRecords(*tile);
        scan_.grid = las_.grid();
        scan_.records = std::make_shared<const import_octree::LasDecoder>(las_, std::vector<LasColumn>());
        return {};
    }

    /// The tile; what its head says becomes that of all.
    Expected<TileBytes> takeHead(std::uint32_t voxel) {
        const std::string name = tileOf(voxel);
        // As in records().
        for (int tries = 2;; --tries) {
            auto tile = files_->read(name, mostBytes(voxel));
            if (!tile) return tile;
            auto head = headOfTile(*tile);
            if (head && !std::isfinite(head->grid().reach()))
                head = fail(ErrorCode::Malformed, "its points may be infinitely far away");
            if (head) {
                las_ = *head;
                return tile;
            }
            if (!files_->forget(name) || tries == 1)
                return fail(head.error().code, "its file " + name + ": " + head.error().message);
        }
    }

    /// The coordinate reference system, where ept.json has none; and what points have besides.
    void takeRecords(std::span<const std::byte> tile) {
        LasVlrs vlrs;
        if (tile.size() >= las_.pointOffset && las_.pointOffset >= las_.headerBytes)
            readVlrs(tile.first(std::size_t(las_.pointOffset)).subspan(las_.headerBytes), las_.vlrs, vlrs);
        auto columns = lasColumns(las_, vlrs.extraBytes, true);
        for (const LasColumn& column : columns) scan_.columns.push_back(column.column);
        scan_.everything = std::make_shared<const import_octree::LasDecoder>(las_, std::move(columns));
        if (!scan_.header.crsWkt.empty() || scan_.header.crsEpsg) return;
        scan_.header.crsWkt = vlrs.crs.wkt;
        scan_.header.crsEpsg = vlrs.crs.epsg ? vlrs.crs.epsg : epsgOfWkt(scan_.header.crsWkt);
    }

    Expected<void> openRecords() {
        shape_.packing = chunk_messages::Packing::Zstd;
        shape_.recordBytes = layout_.bytes();
        if (shape_.recordBytes > 65535)
            return fail(ErrorCode::Malformed, "ept.json: its records are too long");
        auto decoder =
            std::make_shared<const import_octree::FieldDecoder>(layout_, import_octree::Grid(), false);
        const auto own = decoder->grid();
        scan_.isGridOwn = own.has_value();
        scan_.grid =
            own.value_or(StepGrid{scan_.cube.center, glm::dvec3(scan_.cube.halfSize / stepsInHalfCube)});
        if (!own) scan_.header.gridStep = scan_.header.gridOrigin = glm::dvec3(0);
        if (!own && !(scan_.grid.step.x > 0))
            return fail(ErrorCode::Malformed, "ept.json: its bounds are no cube: too small");
        scan_.records = std::move(decoder);
        scan_.everything =
            std::make_shared<const import_octree::FieldDecoder>(layout_, import_octree::Grid(), true);
        scan_.columns = import_octree::columnsOf(layout_.kept());
        return {};
    }

    Expected<TileBytes> unpacked(std::uint32_t points, const TileBytes& tile) const {
        if (data_ == EptData::Zstandard) return decoders_->decode(shape_, points, tile);
        if (data_ == EptData::Binary) {
            const std::uint64_t wanted = std::uint64_t(points) * shape_.recordBytes;
            if (tile.size() == wanted) return tile;
            return fail(
                tile.size() < wanted ? ErrorCode::Truncated : ErrorCode::Malformed,
                fmt::format("it has {} bytes; its {} points of {} bytes need {}", grouped(tile.size()),
                            grouped(points), shape_.recordBytes, grouped(wanted)));
        }
        const auto head = headOfTile(tile);
        if (!head) return passOn(head);
        if (head->points != points)
            return fail(ErrorCode::Malformed, fmt::format("it holds {} points; its hierarchy says {}",
                                                          grouped(head->points), grouped(points)));
        if (head->pointFormat != las_.pointFormat || head->recordBytes != las_.recordBytes ||
            head->grid() != las_.grid())
            return fail(ErrorCode::Malformed,
                        std::string("its records, or their grid, are others than those of other tiles") +
                            ingestInstead);
        return decoders_->decode(shape_, points, tile);
    }

    const std::shared_ptr<const FolderReader> files_;
    const std::shared_ptr<ChunkDecoders> decoders_;
    EptData data_ = EptData::Laszip;
    import_octree::PointLayout layout_;  ///< of plain records
    LasHeader las_;                      ///< of tiles of LAZ
    ChunkShape shape_;
    NativeScan scan_;
};

}  // namespace

Expected<std::shared_ptr<const CloudFile>> openEpt(std::shared_ptr<const FolderReader> files,
                                                   std::shared_ptr<ChunkDecoders> decoders,
                                                   NativeCloudOptions options) {
    auto voxels = std::make_unique<EptVoxels>(std::move(files), std::move(decoders));
    Expected<std::unique_ptr<VoxelSource>> source;
    if (auto ok = guarded("Opening EPT", [&] { return voxels->open(options.upperPoints); }); !ok)
        source = passOn(std::move(ok));
    else
        source = std::move(voxels);
    return openNativeCloud(std::move(source), std::move(options));
}

}  // namespace scancast
