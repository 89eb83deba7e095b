// A raster on its way out as a (Big)TIFF, from its first byte to its last: blocks of cells in, bytes of the file out, in the order in which
// they stand there. Owned and used by one thread at a time. Pipeline: elevation, orthophoto → **raster's TIFF** → answer, file.
//
// A TIFF's head says where its directory is, and that where each tile is. Of tiles that are not packed all of this is known before there
// are any: bytes go out as blocks come in, and nothing is kept. Packed ones wait in an unnamed temporary file until the last has its
// place (docs/decisions/031-rasters.md).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "files/scratch_file.hpp"
#include "renderer/raster/tiff_bytes.hpp"

namespace scancast {

/// Where packed tiles wait, and how much they may be.
struct RasterScratch {
    std::filesystem::path folder{};
    std::string chosenWith{};  ///< for messages (ScratchFile::create)
    std::uint64_t mostBytes = std::uint64_t(1) << 40;
};

class RasterTiff {
  public:
    /// Errors of all members: ScratchFile's; ResourceLimit where packed tiles are more than may wait; Internal.
    static Expected<std::unique_ptr<RasterTiff>> create(RasterLayout layout, const RasterScratch& scratch);

    const RasterLayout& layout() const { return layout_; }
    /// Its cells are wanted next; nullopt: all are there.
    std::optional<CellWindow> nextBlock() const;
    /// The next block's cells, row by row from its top, bytesPerCell each.
    Expected<void> put(std::span<const std::byte> cells);

    /// Bytes that take() gives now, without another block.
    std::uint64_t ready() const;
    /// Nothing follows.
    bool isDone() const { return !nextBlock() && ready() == 0; }
    /// The file's next ones, at most so many.
    Expected<std::vector<std::byte>> take(std::size_t most);
    /// Of the whole file, once that is known: of one that is not packed, at once.
    std::optional<std::uint64_t> size() const { return size_; }

  private:
    RasterTiff(RasterLayout layout, std::uint64_t mostPacked);
    Expected<void> beginPlain();
    Expected<void> beginPacked(const RasterScratch& scratch);
    std::vector<std::int64_t> tilesOf(const CellWindow& block) const;
    void cutTile(std::int64_t tile, const CellWindow& block, std::span<const std::byte> cells);

    const RasterLayout layout_;
    const std::uint64_t mostPacked_;
    std::int64_t block_ = 0;        ///< the next one
    std::vector<std::byte> tile_;   ///< the current one
    std::vector<std::byte> plain_;  ///< ready, where nothing is packed
    std::vector<std::byte> tail_;
    std::unique_ptr<ScratchFile> scratch_;
    std::optional<TiffBytes> packed_;
    std::optional<std::uint64_t> size_;
    std::uint64_t taken_ = 0;
};

}  // namespace scancast
