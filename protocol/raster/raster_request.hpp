// What a client asks of a raster in plan: the words of GET /clouds/{id}/dem.tif and …/ortho.tif, which are flags of commands, too.
// Plain values and their words. Pure functions; any thread. Pipeline: query → **request** → grid → elevation, orthophoto → TIFF.
//
// Coordinates and lengths are the file's own. What is left open is the cloud's to say: its bounds, a cell that suits its spacing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "protocol/error.hpp"
#include "protocol/view/query.hpp"

namespace scancast {

enum class RasterKind : std::uint8_t { Elevation, Orthophoto };

/// Of the points in a cell: their heights, or how many they are.
enum class CellValue : std::uint8_t { Highest, Lowest, Mean, Count };
inline constexpr std::array<std::string_view, 4> cellValueNames{"highest", "lowest", "mean", "count"};
constexpr std::string_view name(CellValue value) {
    return cellValueNames[std::size_t(value)];
}

/// Deflate: every tile by itself, with the predictor that suits its numbers. None: every byte's place is known before there are any.
enum class RasterPacking : std::uint8_t { None, Deflate };
inline constexpr std::array<std::string_view, 2> rasterPackingNames{"none", "deflate"};
constexpr std::string_view name(RasterPacking packing) {
    return rasterPackingNames[std::size_t(packing)];
}

/// How far a hole's surroundings may be, in cells.
inline constexpr int mostFill = 64;

struct RasterRequest {
    RasterKind kind = RasterKind::Elevation;
    std::optional<std::array<double, 4>> bbox{};  ///< least x and y, most x and y
    std::optional<double> cell{};                 ///< side of a cell, or pixel
    CellValue value = CellValue::Highest;         ///< of elevation
    int fill = 0;                                 ///< of elevation: 0 - mostFill
    RasterPacking packing = RasterPacking::Deflate;
    int tile = 256;  ///< side of a tile: 256 or 512
    /// Those of a view, as they were given: which points count, and of an orthophoto all that decides its looks.
    WordValues view{};
};

/// A word of a raster's own; those of views are in view_words.hpp.
struct RasterWord {
    std::string_view word, shape, meaning, example;
    bool elevationOnly = false;
};
std::span<const RasterWord> rasterWords();

/// Whether this word of a view says something of such a raster: of elevation which points count, of an orthophoto everything
/// but the camera, the size and what JPEGs are encoded by.
bool isWordOf(RasterKind kind, std::string_view viewWord);

/// InvalidArgument with the word as field: one that is not known, is given twice, means nothing here, or has a value that is none.
/// What words of views say is not looked at.
Expected<RasterRequest> rasterRequestOf(RasterKind kind, const WordValues& words);
/// The same the other way, without what is as it is by default. In the table's order; the view's words behind, sorted.
WordValues wordsOf(const RasterRequest& request);

}  // namespace scancast
