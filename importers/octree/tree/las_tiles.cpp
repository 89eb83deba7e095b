#include "importers/octree/tree/las_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "files/bytes.hpp"
#include "importers/laz/decoder/laz_file.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/las/las_vlrs.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::uint64_t decoderBytes = std::uint64_t(3) << 20;  // with the table of a file's chunks

class TileAccess final : public laz::RandomAccess {
  public:
    explicit TileAccess(std::unique_ptr<TreeFile> file) : file_(std::move(file)) {}

    std::uint64_t size() const override { return file_->bytes(); }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        if (offset >= file_->bytes()) return 0;
        const auto there = std::min<std::uint64_t>(into.size(), file_->bytes() - offset);
        if (auto ok = file_->read(offset, into.first(there)); !ok) return passOn(ok);
        return there;
    }

  private:
    std::unique_ptr<TreeFile> file_;
};

tl::unexpected<Error> inTile(const std::string& name, const Error& error) {
    return fail(error.code, "its file " + name + ": " + error.message);
}

/// A tile's file, taken apart, and what its records mean.
struct OpenTile {
    laz::LazFile file;
    LasHeader header;
    LasVlrs vlrs;
};

Expected<OpenTile> openTile(const TreeFiles& files, const std::string& name) {
    auto bytes = files.open(name);
    if (!bytes) return passOn(bytes);
    auto file = laz::LazFile::open(std::make_shared<TileAccess>(std::move(*bytes)));
    if (!file) return inTile(name, file.error());
    const auto head = file->head();
    auto header = parseLasHeader(head.first(std::min(head.size(), lasHeaderBytes)), "its file " + name);
    if (!header) return passOn(header);
    LasVlrs vlrs;
    if (head.size() > header->headerBytes) readVlrs(head.subspan(header->headerBytes), header->vlrs, vlrs);
    return OpenTile{std::move(*file), *header, std::move(vlrs)};
}

ScanHeader scanOf(const OpenTile& tile, bool keep) {
    auto scan = scanHeader(tile.header);
    scan.crsWkt = tile.vlrs.crs.wkt;
    scan.crsEpsg = tile.vlrs.crs.epsg ? tile.vlrs.crs.epsg : epsgOfWkt(scan.crsWkt);
    if (keep)
        for (const auto& column : lasColumns(tile.header, tile.vlrs.extraBytes))
            scan.columns.push_back(column.column);
    return scan;
}

}  // namespace

Expected<std::uint64_t> LasTiles::add(const std::string& name) {
    const auto tile = openTile(files_, name);
    if (!tile && tile.error().code == ErrorCode::Empty) return 0;
    if (!tile) return passOn(tile);
    auto scan = scanOf(*tile, keep_);
    if (tiles_.empty()) {
        first_ = std::move(scan);
        color_ = first_.attributes.color;
    } else if (auto ok = compare(scan, name); !ok) {
        return passOn(ok);
    }
    // Of a grid whose numbers are not all coordinates, positions become float64, and some are dropped.
    oneGrid_ = sameGrid_ && std::isfinite(tile->header.grid().reach());
    tiles_.push_back({name, tile->header.points, tile->header.recordBytes});
    return tile->header.points;
}

Expected<void> LasTiles::compare(const ScanHeader& scan, const std::string& name) {
    if (scan.attributes != first_.attributes)
        return fail(ErrorCode::Unsupported,
                    "some of its files have colours and some have none (" + name + ")");
    if (scan.columns != first_.columns)
        return fail(ErrorCode::Unsupported,
                    "its files differ in what is to be kept of their points (" + name + ")");
    sameGrid_ = sameGrid_ && scan.gridStep == first_.gridStep && scan.gridOrigin == first_.gridOrigin;
    return {};
}

void LasTiles::describe(ScanHeader& header) const {
    header.attributes = first_.attributes;
    header.columns = first_.columns;
    header.gridStep = sameGrid_ ? first_.gridStep : glm::dvec3(0);
    header.gridOrigin = sameGrid_ ? first_.gridOrigin : glm::dvec3(0);
    if (!header.crsWkt.empty() || header.crsEpsg) return;
    header.crsWkt = first_.crsWkt;
    header.crsEpsg = first_.crsEpsg;
}

std::uint64_t LasTiles::memoryOf(std::size_t tile) const {
    return decoderBytes + slicesMemory(tiles_[tile].recordBytes, tiles_[tile].points);
}

Expected<void> LasTiles::read(std::size_t index, const Wanted& wanted,
                              const Octree::TakeRecords& take) const {
    const auto& [name, points, recordBytes] = tiles_[index];
    const auto tile = openTile(files_, name);
    if (!tile) return passOn(tile);
    if (tile->header.points != points || tile->header.recordBytes != recordBytes)
        return fail(ErrorCode::Malformed, "its file " + name + " is another than it was a moment ago");
    const LasDecoder decoder(
        tile->header, keep_ ? lasColumns(tile->header, tile->vlrs.extraBytes) : std::vector<LasColumn>());
    laz::LazDecoder unpacker(tile->file, wanted.onlyColors ? laz::Wanted::Colors : laz::Wanted::Everything);
    std::vector<std::byte> records;
    std::uint64_t done = 0;
    for (const auto& chunk : tile->file.chunks()) {
        if (done >= wanted.points) return {};
        if (auto ok = unpacker.start(chunk); !ok) return inTile(name, ok.error());
        while (unpacker.left() > 0 && done < wanted.points) {
            const auto count =
                std::min({unpacker.left(), std::uint64_t(sliceRecords(recordBytes)), wanted.points - done});
            records.resize(count * recordBytes);
            if (auto ok = unpacker.read(records); !ok) return inTile(name, ok.error());
            const auto more = take(decoder, records);
            if (!more) return passOn(more);
            if (!*more) return {};
            done += count;
        }
    }
    return {};
}

}  // namespace scancast::import_octree
