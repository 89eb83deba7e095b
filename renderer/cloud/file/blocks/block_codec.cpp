#include "renderer/cloud/file/blocks/block_codec.hpp"

#include <algorithm>

#include "renderer/cloud/file/blocks/byte_planes.hpp"
#include "renderer/cloud/file/blocks/sample_planes.hpp"

namespace scancast {

namespace {

/// Planes of the chunk in hand; kept by each thread for its next one.
std::span<std::byte> scratch(std::size_t bytes) {
    thread_local std::vector<std::byte> buffer;
    if (buffer.size() < bytes) buffer.resize(bytes);
    return std::span(buffer).first(bytes);
}

tl::unexpected<Error> wrongSize() {
    return fail(ErrorCode::Malformed, "the block does not decode to as many samples as its node has");
}

/// Checked before anything is allocated for it.
bool canHold(std::span<const std::byte> block, std::size_t records, std::size_t recordBytes) {
    return records == 0 || (recordBytes > 0 && records <= block.size() * largestExpansion / recordBytes);
}

}  // namespace

std::vector<std::byte> encodeSamples(std::span<const Sample> samples) {
    std::vector<std::byte> block;
    block.reserve(samples.size_bytes() * 5 / 8);
    for (std::size_t first = 0; first < samples.size(); first += chunkRecords) {
        const auto chunk = samples.subspan(first, std::min(chunkRecords, samples.size() - first));
        const auto planes = scratch(chunk.size_bytes());
        toPlanes(chunk, planes);
        packPlanes(planes, chunk.size(), block);
    }
    return block;
}

Expected<void> decodeSamples(std::span<const std::byte> block, std::span<Sample> into) {
    if (!canHold(block, into.size(), sizeof(Sample))) return wrongSize();
    for (std::size_t first = 0; first < into.size(); first += chunkRecords) {
        const auto chunk = into.subspan(first, std::min(chunkRecords, into.size() - first));
        const auto planes = scratch(chunk.size_bytes());
        if (auto ok = unpackPlanes(block, chunk.size(), planes); !ok) return ok;
        fromPlanes(planes, chunk);
    }
    if (!block.empty()) return wrongSize();
    return {};
}

std::vector<std::byte> encodeRows(std::span<const std::byte> rows, std::size_t rowBytes) {
    std::vector<std::byte> block;
    const std::size_t count = rowBytes > 0 ? rows.size() / rowBytes : 0;
    for (std::size_t first = 0; first < count; first += chunkRecords) {
        const std::size_t n = std::min(chunkRecords, count - first);
        const auto planes = scratch(n * rowBytes);
        const std::byte* from = &rows[first * rowBytes];
        for (std::size_t b = 0; b < rowBytes; ++b)
            for (std::size_t i = 0; i < n; ++i) planes[b * n + i] = from[i * rowBytes + b];
        packPlanes(planes, n, block);
    }
    return block;
}

Expected<std::vector<std::byte>> decodeRows(std::span<const std::byte> block, std::size_t rowBytes,
                                            std::size_t rows) {
    if (!canHold(block, rows, rowBytes)) return wrongSize();
    std::vector<std::byte> out(rows * rowBytes);
    for (std::size_t first = 0; first < rows; first += chunkRecords) {
        const std::size_t n = std::min(chunkRecords, rows - first);
        const auto planes = scratch(n * rowBytes);
        if (auto ok = unpackPlanes(block, n, planes); !ok) return passOn(ok);
        std::byte* to = &out[first * rowBytes];
        for (std::size_t b = 0; b < rowBytes; ++b)
            for (std::size_t i = 0; i < n; ++i) to[i * rowBytes + b] = planes[b * n + i];
    }
    if (!block.empty()) return wrongSize();
    return out;
}

}  // namespace scancast
