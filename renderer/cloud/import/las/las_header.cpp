#include "renderer/cloud/import/las/las_header.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

// Offsets in the public header block, ASPRS LAS 1.4 R15, table 3; of LAS 1.5, the same and more.
enum At : std::size_t {
    atEncoding = 6,
    atMajor = 24,
    atMinor = 25,
    atHeaderSize = 94,
    atPointOffset = 96,
    atVlrCount = 100,
    atPointFormat = 104,
    atRecordLength = 105,
    atLegacyPoints = 107,
    atScale = 131,
    atOffset = 155,
    atBounds = 179,  // max x, min x, max y, min y, max z, min z
    atEvlrOffset = 235,
    atEvlrCount = 243,
    atPoints = 247,
    atTimeOffset = 391,
};
constexpr std::size_t shortestHeader = 227, headerOf14 = 375;
constexpr int newestMinor = 5;
// Of the global encoding: GPS times are not of the week; what is taken from them stands in the header (LAS 1.5).
constexpr unsigned standardTime = 1, timeOffsetIsGiven = 64;

tl::unexpected<Error> malformed(const std::string& name, std::size_t at, const std::string& reason) {
    return fail(ErrorCode::Malformed, fmt::format("{}: {}", lasPlace(name, at), reason));
}

Expected<void> checkVersion(std::span<const std::byte> bytes, const std::string& name) {
    const int major = loadLe<std::uint8_t>(bytes.data() + atMajor);
    const int minor = loadLe<std::uint8_t>(bytes.data() + atMinor);
    if (major == 1 && minor <= newestMinor) return {};
    return fail(ErrorCode::Unsupported,
                fmt::format("{}: LAS version {}.{} is not known here; LAS 1.0 to 1.{} are",
                            lasPlace(name, atMajor), major, minor, newestMinor));
}

Expected<void> checkPointFormat(int format, const std::string& name) {
    // LASzip marks a compressed file by the two highest bits of the point format.
    if ((format & 0xc0) != 0)
        return fail(
            ErrorCode::Unsupported,
            lasSubject(name) +
                " is LAZ (compressed LAS), which is read from files only: save it to a file and open that");
    if (format <= 10) return {};
    return fail(ErrorCode::Unsupported,
                fmt::format("{}: point format {} is not known here; point formats 0 to 10 are",
                            lasPlace(name, atPointFormat), format));
}

std::size_t headerBytesOf(int minorVersion) {
    return minorVersion >= 5 ? lasHeaderBytes : minorVersion == 4 ? headerOf14 : shortestHeader;
}

std::optional<std::uint64_t> readTimeOffset(const std::byte* data, int minorVersion) {
    const unsigned encoding = loadLe<std::uint16_t>(data + atEncoding);
    if ((encoding & standardTime) == 0) return std::nullopt;
    if (minorVersion < 5 || (encoding & timeOffsetIsGiven) == 0) return 1'000'000'000;
    return std::uint64_t(1'000'000) * loadLe<std::uint16_t>(data + atTimeOffset);
}

Expected<void> readGrid(const std::byte* data, const std::string& name, LasHeader& header) {
    static constexpr char axis[] = "xyz";
    for (std::size_t i = 0; i < 3; ++i) {
        const auto scale = loadLe<double>(data + atScale + 8 * i);
        const auto offset = loadLe<double>(data + atOffset + 8 * i);
        if (!std::isfinite(scale) || scale <= 0)
            return malformed(
                name, atScale + 8 * i,
                fmt::format("the scale of {} is {:f}; it must be a positive number", axis[i], scale));
        if (!std::isfinite(offset))
            return malformed(name, atOffset + 8 * i,
                             fmt::format("the offset of {} is not a number", axis[i]));
        header.scale[static_cast<int>(i)] = scale;
        header.offset[static_cast<int>(i)] = offset;
        header.bounds[1][static_cast<int>(i)] = loadLe<double>(data + atBounds + 16 * i);
        header.bounds[0][static_cast<int>(i)] = loadLe<double>(data + atBounds + 16 * i + 8);
    }
    return {};
}

}  // namespace

std::string lasSubject(const std::string& name) {
    return name.empty() ? "it" : name;
}

std::string lasPlace(const std::string& name, std::size_t at) {
    return fmt::format("{}byte {}", name.empty() ? "" : name + ", ", at);
}

const LasRecordLayout& lasRecordLayout(int pointFormat) {
    // Bytes, classification, mask, colour, infrared, waveform: ASPRS LAS 1.4 R15, tables 7-17.
    static constexpr LasRecordLayout layouts[] = {
        {20, 15, 0x1f, -1, -1, false}, {28, 15, 0x1f, -1, -1, false}, {26, 15, 0x1f, 20, -1, false},
        {34, 15, 0x1f, 28, -1, false}, {57, 15, 0x1f, -1, -1, true},  {63, 15, 0x1f, 28, -1, true},
        {30, 16, 0xff, -1, -1, false}, {36, 16, 0xff, 30, -1, false}, {38, 16, 0xff, 30, 36, false},
        {59, 16, 0xff, -1, -1, true},  {67, 16, 0xff, 30, 36, true},
    };
    return layouts[pointFormat];
}

Expected<LasHeader> parseLasHeader(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.size() < 4 || std::memcmp(bytes.data(), "LASF", 4) != 0)
        return malformed(name, 0, "not a LAS file, it does not start with \"LASF\"");
    if (bytes.size() < shortestHeader)
        return fail(ErrorCode::Truncated,
                    fmt::format("{} ends at byte {}, within its LAS header of at least 227 bytes",
                                lasSubject(name), bytes.size()));
    const auto* data = bytes.data();
    LasHeader header;
    if (auto ok = checkVersion(bytes, name); !ok) return passOn(ok);
    header.minorVersion = loadLe<std::uint8_t>(data + atMinor);
    header.pointFormat = loadLe<std::uint8_t>(data + atPointFormat);
    if (auto ok = checkPointFormat(header.pointFormat, name); !ok) return passOn(ok);

    header.headerBytes = loadLe<std::uint16_t>(data + atHeaderSize);
    const std::size_t needed = headerBytesOf(header.minorVersion);
    if (header.headerBytes < needed)
        return malformed(name, atHeaderSize,
                         fmt::format("the header says that it has {} bytes; LAS 1.{} needs {}",
                                     header.headerBytes, header.minorVersion, needed));
    if (bytes.size() < needed)
        return fail(ErrorCode::Truncated, fmt::format("{} ends at byte {}, within its LAS header of {} bytes",
                                                      lasSubject(name), bytes.size(), needed));
    header.pointOffset = loadLe<std::uint32_t>(data + atPointOffset);
    if (header.pointOffset < header.headerBytes)
        return malformed(
            name, atPointOffset,
            fmt::format("the points are said to start at byte {}, within the header", header.pointOffset));
    header.recordBytes = loadLe<std::uint16_t>(data + atRecordLength);
    const auto least = lasRecordLayout(header.pointFormat).bytes;
    if (header.recordBytes < least)
        return malformed(name, atRecordLength,
                         fmt::format("a point record has {} bytes; point format {} needs {}",
                                     header.recordBytes, header.pointFormat, least));
    if (auto ok = readGrid(data, name, header); !ok) return passOn(ok);

    header.timeOffset = readTimeOffset(data, header.minorVersion);
    header.vlrs = loadLe<std::uint32_t>(data + atVlrCount);
    header.points = loadLe<std::uint32_t>(data + atLegacyPoints);
    if (header.minorVersion >= 4) {
        // The old 32-bit count is a courtesy to old readers: 0 for large clouds, and stale in some files.
        if (const auto points = loadLe<std::uint64_t>(data + atPoints); points != 0) header.points = points;
        header.evlrOffset = loadLe<std::uint64_t>(data + atEvlrOffset);
        header.evlrs = loadLe<std::uint32_t>(data + atEvlrCount);
    }
    if (header.points == 0)
        return fail(ErrorCode::Empty,
                    lasSubject(name) + " is a LAS file without points (byte 107: 0 points)");
    return header;
}

ScanHeader scanHeader(const LasHeader& header) {
    ScanHeader scan;
    scan.format = fmt::format("LAS 1.{}, point format {}", header.minorVersion, header.pointFormat);
    scan.points = header.points;
    scan.attributes.color = lasRecordLayout(header.pointFormat).color >= 0;
    scan.attributes.nearInfrared = lasRecordLayout(header.pointFormat).infrared >= 0;
    scan.attributes.intensity = true;
    scan.attributes.classification = true;
    scan.gridStep = header.scale;
    scan.gridOrigin = header.offset;
    bool usable = true;
    for (int i = 0; i < 3; ++i) usable = usable && header.bounds[0][i] <= header.bounds[1][i];
    if (usable) scan.bounds = header.bounds;
    return scan;
}

}  // namespace scancast
