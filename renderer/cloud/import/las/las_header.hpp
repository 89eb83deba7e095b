// The public header block of a LAS file (ASPRS LAS 1.0-1.5), parsed and checked. Pure functions on bytes.
// Pipeline: bytes → **header** → records → points.
//
// What cannot harm the points is tolerated: wrong bounds, counts by return, VLR counts, dates, waveform
// offsets. What makes the points doubtful is refused: scale, offset, record length, position and number of
// the records.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>

#include "protocol/error.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// The longest header of the versions we read (1.5); 1.0-1.2 have 227 bytes, 1.3 has 235, 1.4 has 375.
inline constexpr std::size_t lasHeaderBytes = 393;

struct LasHeader {
    int minorVersion = 0;  ///< 0-5
    int pointFormat = 0;   ///< 0-10
    std::uint32_t headerBytes = 0;
    std::uint64_t pointOffset = 0;  ///< first byte of the first point record
    std::uint32_t recordBytes = 0;  ///< ≥ what the point format needs; the rest are extra bytes
    std::uint64_t points = 0;
    /// GPS times are standard time less so many seconds (1e9, in LAS 1.5 what it says); nothing: seconds of the week.
    std::optional<std::uint64_t> timeOffset;
    std::uint32_t vlrs = 0;        ///< as declared: a hint
    std::uint64_t evlrOffset = 0;  ///< 0 = none
    std::uint32_t evlrs = 0;
    glm::dvec3 scale{1}, offset{0};
    std::array<glm::dvec3, 2> bounds{};

    /// Of the point records: position = offset + scale · number.
    StepGrid grid() const { return {offset, scale}; }
};

/// Where a point record keeps its fields, by point format; -1 = not there.
struct LasRecordLayout {
    std::uint32_t bytes;  ///< without extra bytes
    int classification;
    std::uint8_t classMask;  ///< the rest of that byte are flags (synthetic, withheld …)
    int color;               ///< red, green, blue: three 16-bit numbers
    int infrared;            ///< near infrared, one 16-bit number
    bool waveform;           ///< its last 29 bytes say where the waveform is
};

/// Shape of point formats 0-10.
const LasRecordLayout& lasRecordLayout(int pointFormat);

/// `bytes`: the first bytes of the file, up to lasHeaderBytes; fewer when the file ends there. `name` is what
/// messages call it; empty where somebody puts the name in front of them. Errors: Malformed, Truncated, Unsupported (LAZ, versions and point formats unknown),
/// Empty.
Expected<LasHeader> parseLasHeader(std::span<const std::byte> bytes, const std::string& name);

/// "scan.las", or "it"; "scan.las, byte 5", or "byte 5".
std::string lasSubject(const std::string& name);
std::string lasPlace(const std::string& name, std::size_t at);

/// What the rest of Scancast wants to know of it; without CRS.
ScanHeader scanHeader(const LasHeader& header);

}  // namespace scancast
