// The point stream's layout (POINT_STREAM.md): header, records, bounds. Pure functions on bytes.
// Pipeline: importer process → **point stream** → points.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::point_stream {

inline constexpr std::array<std::uint8_t, 8> magic{'S', 'C', 'A', 'N', 'P', 'T', 'S', 0x1a};
inline constexpr std::uint16_t version = 1;        ///< what every reader of point streams reads
inline constexpr std::uint16_t newestVersion = 2;  ///< with positions as steps, or records of LAS
inline constexpr std::size_t headerBytes = 136;
inline constexpr std::size_t scannerBytes = 24;
inline constexpr std::size_t longestFormat = 256;
inline constexpr std::size_t longestWkt = 65536;
inline constexpr std::size_t longestFailure = 4096;
inline constexpr std::size_t longestNote = 1024;
inline constexpr std::size_t mostNotes = 32;
inline constexpr std::size_t recordHeadBytes = 8;
inline constexpr std::uint32_t chunkPoints = 65536;
inline constexpr std::uint32_t glancePoints = 65536;
inline constexpr std::size_t stepBytes = 12;                                 ///< of a position
inline constexpr std::size_t lasLengthsBytes = 8;                            ///< of head and extended records
inline constexpr std::size_t longestLasPart = std::size_t(16) << 20;         ///< head; extended records
inline constexpr std::uint64_t longestLasRecords = std::uint64_t(16) << 20;  ///< bytes of one RECS or LOOK
static_assert(chunkPoints == PointSource::batchPoints);

inline constexpr std::array<char, 4> chunkTag{'C', 'H', 'N', 'K'};
inline constexpr std::array<char, 4> glanceTag{'L', 'O', 'O', 'K'};
inline constexpr std::array<char, 4> doneTag{'D', 'O', 'N', 'E'};
inline constexpr std::array<char, 4> failTag{'F', 'A', 'I', 'L'};
inline constexpr std::array<char, 4> recordsTag{'R', 'E', 'C', 'S'};
inline constexpr std::array<char, 4> peakTag{'P', 'E', 'A', 'K'};
inline constexpr std::array<char, 4> noteTag{'N', 'O', 'T', 'E'};
inline constexpr std::array<char, 4> stationTag{'S', 'T', 'N', 'D'};
inline constexpr std::array<char, 4> fromTag{'F', 'R', 'O', 'M'};
inline constexpr std::array<char, 4> photoTag{'P', 'I', 'C', 'T'};
inline constexpr std::array<char, 4> photoBytesTag{'P', 'I', 'X', 'L'};

/// Bytes of one point in a chunk.
std::size_t pointBytes(const Attributes& attributes, bool areSteps = false);

/// Header and its three texts; texts that are too long are cut. `newest`: as version 2; so are headers where positions are steps of
/// their grid.
std::vector<std::byte> encodeHeader(const ScanHeader& header, bool areSteps = false, bool newest = false);

/// What comes before records of LAS.
struct LasPreamble {
    std::string format;                   ///< for people: "LAZ 1.4, point format 7"
    std::optional<std::uint64_t> points;  ///< as the head has it; nullopt = as many as there are
    std::span<const std::byte> head;  ///< public header block and variable length records, without LAZ's bits
    std::span<const std::byte> evlrs;  ///< one behind the other
};
/// Header, format text, head and extended records, each at most longestLasPart.
std::vector<std::byte> encodeLasHeader(const LasPreamble& las);

/// How the rest of the header is to be read.
struct DecodedHeader {
    ScanHeader header;
    std::uint16_t version = 0;
    bool areSteps = false;    ///< positions are steps of the header's grid
    bool isLas = false;       ///< behind the texts follow the parts of LAS
    bool hasScanner = false;  ///< scannerBytes follow, then the texts
    std::uint32_t formatBytes = 0;
    std::uint32_t wktBytes = 0;
    std::uint32_t columnsBytes = 0;
};
/// `bytes`: headerBytes of them. Errors (Importer) without a file's name.
Expected<DecodedHeader> decodeHeader(std::span<const std::byte> bytes);

/// Where the scanner stood. Errors as above.
Expected<glm::dvec3> decodeScanner(std::span<const std::byte, scannerBytes> bytes);

/// Code of a FAIL record and back; an unknown number is Importer.
std::uint32_t failureCode(ErrorCode code);
ErrorCode failureCode(std::uint32_t number);

}  // namespace scancast::point_stream
