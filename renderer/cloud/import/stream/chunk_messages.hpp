// What is said between Scancast and a program that decodes points for it (`scancast-import-laz --chunks`, `scancast-import-octree --chunks`):
// requests on its standard input, one answer to each on its standard output, for as long as the input is open. Scancast fetches, the
// program decodes: it opens nothing. Pure functions on bytes. Pipeline: chunk → **request** → decoder → **answer** → records.
//
//   request: magic "SCQ2", u32 how it is packed, u32 point format (of zstd: 0), u32 bytes of a record, u32 L, u32 0, u64 points, u64 C;
//            then L bytes, the content of the file's record "laszip encoded", and C bytes, the chunk.
//   packed:  0 a chunk of LAZ (scancast-import-laz); 1 a whole file of LAZ or LAS, 2 records as they are, compressed by zstd
//            (scancast-import-octree; L is 0).
//   answer:  magic "SCA1", u32 0 or an error, u64 N; then N bytes: points × bytes of a record, or half a sentence on why not.
//
// All numbers are little-endian. An error: 1 malformed, 2 truncated, 3 unsupported, 4 not enough memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "protocol/error.hpp"

namespace scancast::chunk_messages {

/// Of one chunk, compressed and decoded; nothing that is larger is asked for or answered.
inline constexpr std::uint64_t mostChunkBytes = 256 << 20;
inline constexpr std::uint64_t mostRecordBytes = 128 << 20;
inline constexpr std::uint32_t longestLaszip = 65536;
inline constexpr std::uint64_t longestReason = 1024;

inline constexpr std::size_t requestHeadBytes = 40;
inline constexpr std::size_t answerHeadBytes = 16;

enum class Packing : std::uint32_t { LazChunk, LazFile, Zstd };

struct RequestHead {
    Packing packing = Packing::LazChunk;
    std::uint32_t pointFormat = 0, recordBytes = 0, laszipBytes = 0;
    std::uint64_t points = 0, chunkBytes = 0;
    bool operator==(const RequestHead&) const = default;
};
struct AnswerHead {
    std::optional<ErrorCode> error{};
    std::uint64_t bytes = 0;
    bool operator==(const AnswerHead&) const = default;
};

std::array<std::byte, requestHeadBytes> encode(const RequestHead& head);
std::array<std::byte, answerHeadBytes> encode(const AnswerHead& head);
/// Malformed, where it is none, or asks for more than may be.
Expected<RequestHead> parseRequest(std::span<const std::byte, requestHeadBytes> bytes);
/// Malformed, where it is none, or not the answer to that request.
Expected<AnswerHead> parseAnswer(std::span<const std::byte, answerHeadBytes> bytes,
                                 const RequestHead& request);

}  // namespace scancast::chunk_messages
