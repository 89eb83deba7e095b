#include "renderer/raster/raster_tiff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "protocol/text/grouped.hpp"
#include "renderer/raster/elevation.hpp"

namespace scancast {

RasterTiff::RasterTiff(RasterLayout layout, std::uint64_t mostPacked)
    : layout_(std::move(layout)), mostPacked_(mostPacked), tile_(layout_.tileBytes()) {}

Expected<std::unique_ptr<RasterTiff>> RasterTiff::create(RasterLayout layout, const RasterScratch& scratch) {
    std::unique_ptr<RasterTiff> raster(new RasterTiff(std::move(layout), scratch.mostBytes));
    const bool packs = raster->layout_.packing == RasterPacking::Deflate;
    if (auto ok = packs ? raster->beginPacked(scratch) : raster->beginPlain(); !ok) return passOn(ok);
    return raster;
}

Expected<void> RasterTiff::beginPlain() {
    std::vector<std::int64_t> tiles;
    tiles.reserve(std::size_t(layout_.grid.tiles()));
    for (std::int64_t block = 0; block < layout_.grid.blocks(); ++block)
        for (const std::int64_t tile : tilesOf(layout_.grid.blockAt(block))) tiles.push_back(tile);
    auto skeleton = tiffSkeleton(layout_, tiles);
    if (!skeleton) return passOn(std::move(skeleton));
    plain_ = std::move(skeleton->head);
    tail_ = std::move(skeleton->tail);
    size_ = plain_.size() + layout_.allTiles() + tail_.size();
    return {};
}

Expected<void> RasterTiff::beginPacked(const RasterScratch& scratch) {
    auto file = ScratchFile::create(scratch.folder, scratch.chosenWith);
    if (!file) return passOn(std::move(file));
    scratch_ = std::move(*file);
    const auto write = [this](std::uint64_t at, std::span<const std::byte> bytes) -> Expected<void> {
        if (at + bytes.size() > mostPacked_)
            return fail(
                ErrorCode::ResourceLimit,
                fmt::format(
                    "The raster has more than {} bytes, as many as may wait until it is complete; ask for "
                    "larger cells, a smaller bbox, or compress=none, which does not wait.",
                    grouped(mostPacked_)),
                "cell");
        return scratch_->write(at, bytes);
    };
    auto packed = TiffBytes::create(layout_, write);
    if (!packed) return passOn(std::move(packed));
    packed_.emplace(std::move(*packed));
    return {};
}

std::optional<CellWindow> RasterTiff::nextBlock() const {
    if (block_ >= layout_.grid.blocks()) return std::nullopt;
    return layout_.grid.blockAt(block_);
}

std::vector<std::int64_t> RasterTiff::tilesOf(const CellWindow& block) const {
    const RasterGrid& grid = layout_.grid;
    std::vector<std::int64_t> tiles;
    for (std::int64_t row = block.row / grid.tile; row * grid.tile < block.row + block.rows; ++row)
        for (std::int64_t column = block.column / grid.tile;
             column * grid.tile < block.column + block.columns; ++column)
            tiles.push_back(row * grid.tileColumns() + column);
    return tiles;
}

/// Of those at the right and at the bottom, what is outside of the raster has no value.
void RasterTiff::cutTile(std::int64_t tile, const CellWindow& block, std::span<const std::byte> cells) {
    const RasterGrid& grid = layout_.grid;
    const std::int64_t left = tile % grid.tileColumns() * grid.tile,
                       top = tile / grid.tileColumns() * grid.tile;
    const std::int64_t columns = std::min<std::int64_t>(grid.tile, block.column + block.columns - left);
    const std::int64_t rows = std::min<std::int64_t>(grid.tile, block.row + block.rows - top);
    if (columns < grid.tile || rows < grid.tile) {
        const float nothing = layout_.kind == CellKind::Elevation ? noElevation : 0;
        for (std::size_t at = 0; at < tile_.size(); at += bytesPerCell)
            std::memcpy(&tile_[at], &nothing, bytesPerCell);
    }
    for (std::int64_t row = 0; row < rows; ++row) {
        const auto from =
            std::size_t((top + row - block.row) * block.columns + left - block.column) * bytesPerCell;
        std::memcpy(&tile_[std::size_t(row * grid.tile) * bytesPerCell], &cells[from],
                    std::size_t(columns) * bytesPerCell);
    }
}

Expected<void> RasterTiff::put(std::span<const std::byte> cells) {
    const auto block = nextBlock();
    if (!block || cells.size() != std::size_t(block->cells()) * bytesPerCell)
        return fail(ErrorCode::Internal, "A raster was given other cells than it wants.");
    for (const std::int64_t tile : tilesOf(*block)) {
        cutTile(tile, *block, cells);
        if (!packed_)
            plain_.insert(plain_.end(), tile_.begin(), tile_.end());
        else if (auto ok = packed_->put(tile, tile_); !ok)
            return ok;
    }
    ++block_;
    if (nextBlock()) return {};
    if (!packed_) {
        plain_.insert(plain_.end(), tail_.begin(), tail_.end());
        return {};
    }
    if (auto ok = packed_->finish(); !ok) return ok;
    size_ = packed_->size();
    return {};
}

std::uint64_t RasterTiff::ready() const {
    if (!packed_) return plain_.size();
    return size_ ? *size_ - taken_ : 0;
}

Expected<std::vector<std::byte>> RasterTiff::take(std::size_t most) {
    const auto bytes = std::size_t(std::min<std::uint64_t>(most, ready()));
    std::vector<std::byte> part(bytes);
    if (packed_) {
        if (auto ok = scratch_->read(taken_, part); !ok) return passOn(ok);
    } else {
        std::copy_n(plain_.begin(), bytes, part.begin());
        plain_.erase(plain_.begin(), plain_.begin() + std::ptrdiff_t(bytes));
    }
    taken_ += bytes;
    return part;
}

}  // namespace scancast
