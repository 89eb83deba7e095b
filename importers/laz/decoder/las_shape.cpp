#include "importers/laz/decoder/las_shape.hpp"

#include <cstring>

#include "files/bytes.hpp"
#include "importers/laz/decoder/laszip_record.hpp"

namespace scancast::laz {

namespace {

constexpr std::size_t shortestLasHeader = 227;
constexpr std::uint32_t compressionBits = 0xc0;

tl::unexpected<Error> malformedAt(std::size_t at, const std::string& reason) {
    return fail(ErrorCode::Malformed, "byte " + std::to_string(at) + ": " + reason);
}

Expected<void> checkStart(std::span<const std::byte> bytes) {
    if (bytes.size() < 4 || std::memcmp(bytes.data(), "LASF", 4) != 0)
        return malformedAt(0, "it is not a LAS or LAZ file, it does not start with \"LASF\"");
    if (bytes.size() < shortestLasHeader)
        return fail(ErrorCode::Truncated, "it ends at byte " + std::to_string(bytes.size()) +
                                              ", within its LAS header of at least " +
                                              std::to_string(shortestLasHeader) + " bytes");
    const auto version = bytes.subspan(24, 2);
    if (version[0] == std::byte{1}) return {};
    return fail(ErrorCode::Unsupported,
                "byte 24: LAS version " + std::to_string(static_cast<int>(version[0])) + "." +
                    std::to_string(static_cast<int>(version[1])) + " is not known here");
}

Expected<void> checkShape(std::span<const std::byte> bytes, const LasShape& shape) {
    if (shape.pointFormat > 10)
        return fail(ErrorCode::Unsupported, "byte 104: point format " + std::to_string(shape.pointFormat) +
                                                " is not known here; point formats 0 to 10 are");
    const std::size_t needed = shape.minorVersion >= 4 ? longestLasHeader : shortestLasHeader;
    if (shape.headerBytes < needed)
        return malformedAt(94, "the header says that it has " + std::to_string(shape.headerBytes) +
                                   " bytes; LAS 1." + std::to_string(shape.minorVersion) + " needs " +
                                   std::to_string(needed));
    if (bytes.size() < needed)
        return fail(ErrorCode::Truncated, "it ends at byte " + std::to_string(bytes.size()) +
                                              ", within its LAS header of " + std::to_string(needed) +
                                              " bytes");
    if (shape.pointOffset < shape.headerBytes)
        return malformedAt(96, "the points are said to start at byte " + std::to_string(shape.pointOffset) +
                                   ", within the header");
    const std::uint32_t least = leastRecordBytes(shape.pointFormat);
    if (shape.recordBytes < least)
        return malformedAt(105, "a point record has " + std::to_string(shape.recordBytes) +
                                    " bytes; point format " + std::to_string(shape.pointFormat) + " needs " +
                                    std::to_string(least));
    return {};
}

}  // namespace

Expected<LasShape> parseLasShape(std::span<const std::byte> bytes) {
    if (const auto ok = checkStart(bytes); !ok) return passOn(ok);
    const std::byte* const at = bytes.data();
    LasShape shape;
    shape.minorVersion = static_cast<int>(at[25]);
    const auto marked = static_cast<std::uint32_t>(at[104]);
    shape.compressed = (marked & compressionBits) != 0;
    shape.pointFormat = static_cast<int>(marked & ~compressionBits);
    shape.headerBytes = loadLe<std::uint16_t>(at + 94);
    shape.pointOffset = loadLe<std::uint32_t>(at + 96);
    shape.recordBytes = loadLe<std::uint16_t>(at + 105);
    if (const auto ok = checkShape(bytes, shape); !ok) return passOn(ok);
    shape.vlrs = loadLe<std::uint32_t>(at + 100);
    shape.points = loadLe<std::uint32_t>(at + 107);
    if (shape.minorVersion >= 4) {
        shape.evlrOffset = loadLe<std::uint64_t>(at + 235);
        shape.evlrs = loadLe<std::uint32_t>(at + 243);
        // The old 32-bit count is a courtesy to old readers: 0 for large clouds, and stale in some files.
        if (const auto points = loadLe<std::uint64_t>(at + 247); points != 0) shape.points = points;
    }
    if (shape.points == 0)
        return fail(ErrorCode::Empty, "it is a " + std::string(shape.compressed ? "LAZ" : "LAS") +
                                          " file without points (byte 107: 0 points)");
    return shape;
}

}  // namespace scancast::laz
