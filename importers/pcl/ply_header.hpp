// A PLY file's header, checked before PCL sees the file: PCL trusts what it says. Pure functions.
// The format: http://paulbourke.net/dataformats/ply/
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "importers/pcl/point_fields.hpp"
#include "importers/pcl/raw_rows.hpp"
#include "protocol/error.hpp"

namespace scancast::import_pcl {

enum class PlyFormat : std::uint8_t { Ascii, BinaryLittleEndian, BinaryBigEndian };

struct PlyProperty {
    std::string name;
    ColumnType type = ColumnType::Float32;
    std::optional<ColumnType> listSize;  ///< set for lists: the type of the number of items
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::Ascii;
    std::uint64_t bytes = 0;  ///< the first element starts here
    std::vector<PlyElement> elements;
    std::uint64_t vertices = 0;
    PointFields fields;  ///< of the element "vertex"
    /// Name of the property by meaning; only where `fields` has it.
    std::array<std::string, meanings> propertyOf{};
};

/// Longest header that is read.
inline constexpr std::size_t longestPlyHeader = 1 << 20;

/// `start`: the first bytes of the file, up to longestPlyHeader. `fileBytes`: the file's size, against which
/// the promised vertices are checked; not with `recover`, which is content with those that are there. Errors: Malformed,
/// Truncated, Unsupported, Empty; without the file's name.
Expected<PlyHeader> checkPlyHeader(std::string_view start, std::uint64_t fileBytes, bool recover = false);

/// Where binary vertices of one length stand.
struct VertexRows {
    std::uint64_t at = 0;  ///< byte of the first one
    RowLayout layout{};
};
/// Nothing for text, for vertices with lists, and where elements with lists come first: only who has read these knows where
/// the vertices are.
std::optional<VertexRows> vertexRows(const PlyHeader& header);

}  // namespace scancast::import_pcl
