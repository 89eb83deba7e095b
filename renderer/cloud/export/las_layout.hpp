// How a scan becomes LAS 1.4: which point format has room for what is known of its points, which of the kept columns are
// its fields, and which become extra bytes (ASPRS LAS 1.4 R15, tables 7-17 and 24). Pure functions.
// Pipeline: header of the scan → **layout** → records.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "renderer/cloud/export/export_writer.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// Fields of a record that come from kept columns, by the names that the LAS reader gives them.
enum class LasField : std::uint8_t {
    ReturnNumber,
    NumberOfReturns,
    ScanDirection,
    EdgeOfFlightLine,
    ClassFlags,
    ScannerChannel,
    OldScanAngle,  ///< whole degrees
    NewScanAngle,  ///< 0.006 degrees
    UserData,
    PointSource,
    GpsTime,
    Nir,
    Red,
    Green,
    Blue
};
inline constexpr std::size_t lasFields = std::size_t(LasField::Blue) + 1;

/// Degrees, of LasField::NewScanAngle.
inline constexpr double lasAngleStep = 0.006;

struct LasExtra {
    Column column;
    std::size_t at = 0;  ///< in a row
};

struct LasLayout {
    int pointFormat = 6;  ///< 0-3 or 6-8
    std::uint32_t fieldBytes = 0, recordBytes = 0;
    std::array<std::optional<std::size_t>, lasFields> fields{};  ///< where in a row; nullopt: not known
    std::vector<LasExtra> extras;
    bool normals = false;  ///< behind the extras, three floats: the scan's own
    bool adjustedTime = false;
    bool offsetTime = false;  ///< GPS times count from somewhere that only LAS 1.5 has words for
    glm::dvec3 scale{1}, offset{0};

    bool isNew() const { return pointFormat >= 6; }
    std::optional<std::size_t> field(LasField f) const { return fields[std::size_t(f)]; }
};

/// InvalidArgument where the columns are more than a record holds.
Expected<LasLayout> lasLayout(const ScanHeader& header, const PointSurvey& ahead);

/// The variable length records: coordinate reference system, extra bytes.
struct LasRecords {
    std::vector<std::byte> bytes;
    std::uint32_t count = 0;
    bool wkt = false;
    std::vector<std::string> losses;
};
LasRecords lasRecords(const ScanHeader& header, const LasLayout& layout);

/// The public header block, 375 bytes.
std::vector<std::byte> lasHead(const LasLayout& layout, const LasRecords& records, const PointSurvey& survey);

}  // namespace scancast
