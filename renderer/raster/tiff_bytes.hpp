// A TIFF in the making: libtiff and libgeotiff behind an interface without their headers. They are handed numbers that are ours, and write;
// nothing from outside is parsed. Owned and used by one thread. Pipeline: layout, tiles → **TIFF's bytes** → whoever keeps them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/raster/geo_keys.hpp"
#include "renderer/raster/raster_grid.hpp"

namespace scancast {

enum class CellKind : std::uint8_t {
    Elevation,  ///< float32, noElevation where there is none
    Count,      ///< 32 bits without a sign
    Color,      ///< red, green, blue, straight alpha; a byte each
};
/// Of every kind.
inline constexpr std::size_t bytesPerCell = 4;

/// What is said of a raster beside its cells.
struct RasterLayout {
    RasterGrid grid{};
    CellKind kind = CellKind::Elevation;
    RasterPacking packing = RasterPacking::Deflate;
    std::vector<GeoKey> keys{};
    std::string unit{};         ///< of heights
    std::string value{};        ///< what a cell has: "highest"
    std::string title{};        ///< of the cloud
    std::string attribution{};  ///< whom to name
    std::string recorded{};     ///< "2024-05-13"; empty = not known

    std::size_t tileBytes() const { return std::size_t(grid.tile) * std::size_t(grid.tile) * bytesPerCell; }
    std::uint64_t allTiles() const { return std::uint64_t(grid.tiles()) * tileBytes(); }
    /// Offsets of 32 bits would not do, were nothing packed.
    bool isBig() const { return allTiles() > 4'000'000'000U; }
};

/// Takes bytes at a place of the file; places that were written may be again.
using WriteAt = std::function<Expected<void>(std::uint64_t at, std::span<const std::byte> bytes)>;

class TiffBytes {
  public:
    /// Errors, of all members: those of `write`; Internal where libtiff refuses what we say.
    static Expected<TiffBytes> create(const RasterLayout& layout, WriteAt write);
    TiffBytes(TiffBytes&&) noexcept;
    TiffBytes& operator=(TiffBytes&&) noexcept;
    ~TiffBytes();

    /// Number `index` of the grid's tiles, row by row, tileBytes() of it; packed, unless it is `raw`. Each once, in any order.
    Expected<void> put(std::int64_t index, std::span<const std::byte> tile, bool raw = false);
    /// The directory, behind the tiles. The last call.
    Expected<void> finish();
    std::uint64_t size() const;

  private:
    struct Open;
    explicit TiffBytes(std::unique_ptr<Open> open);
    std::unique_ptr<Open> open_;
};

/// All of a file whose tiles are not packed but the tiles, which lie one behind the other in the order of `tiles` from head's end on.
struct TiffSkeleton {
    std::vector<std::byte> head, tail;
};
Expected<TiffSkeleton> tiffSkeleton(const RasterLayout& layout, std::span<const std::int64_t> tiles);

}  // namespace scancast
