// A PCD file's header, checked before PCL sees the file: PCL crashes on broken ones, and allocates what they
// say. Pure functions. The format: https://pointclouds.org/documentation/tutorials/pcd_file_format.html
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "importers/pcl/point_fields.hpp"
#include "protocol/error.hpp"

namespace scancast::import_pcl {

enum class PcdData : std::uint8_t { Ascii, Binary, BinaryCompressed };

struct PcdField {
    std::string name;
    ColumnType type = ColumnType::Float32;
    std::uint32_t count = 1;
    std::uint32_t offset = 0;  ///< within a point, in bytes
    std::uint32_t bytes() const { return static_cast<std::uint32_t>(bytesOf(type)) * count; }
};

struct PcdHeader {
    std::string version = "0.7";
    PcdData data = PcdData::Ascii;
    std::uint64_t bytes = 0;  ///< the body starts here
    std::vector<PcdField> fields;
    std::uint32_t pointBytes = 0;
    std::uint64_t points = 0;
    /// Where the sensor stood; nullopt at the origin, which is what programs write that do not know it - but for
    /// frames, which have rows and columns.
    std::optional<glm::dvec3> viewpoint;
    PointFields meanings;
    /// Index into `fields` by meaning; only where `meanings` has it.
    std::array<std::size_t, scancast::import_pcl::meanings> fieldOf{};
};

/// Longest header that is read.
inline constexpr std::size_t longestPcdHeader = 1 << 16;

/// `start`: the first bytes of the file, up to longestPcdHeader; `fileBytes`: its size, against which the
/// promised points are checked; not with `recover`, which is content with those that are there. Errors: Malformed, Truncated,
/// Unsupported, Empty; without the file's name.
Expected<PcdHeader> checkPcdHeader(std::string_view start, std::uint64_t fileBytes, bool recover = false);

/// For compressed bodies: the two lengths in front of it against header and file.
Expected<void> checkPcdCompression(const PcdHeader& header, std::uint32_t compressed,
                                   std::uint32_t uncompressed, std::uint64_t fileBytes);

}  // namespace scancast::import_pcl
