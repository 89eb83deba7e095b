#include "renderer/cloud/file/blocks/byte_planes.hpp"

#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>

#include "files/bytes.hpp"

namespace scancast {

namespace {

enum class PlaneKind : std::uint8_t { Constant, Raw, Compressed };

/// Planes hardly repeat themselves: Huffman codes do the work, and looking for matches in wide steps only
/// makes it smaller and twice as fast (decision 006). Steps switch the codes off, unless they are asked for -
/// by a parameter that zstd calls experimental; a version that does not know it writes larger blocks, not
/// wrong ones.
ZSTD_CCtx* createCompressor() {
    ZSTD_CCtx* context = ZSTD_createCCtx();
    if (!context) throw std::bad_alloc();
    constexpr auto literalCompression = ZSTD_c_experimentalParam5;
    constexpr int huffman = 1;
    ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, 1);
    ZSTD_CCtx_setParameter(context, ZSTD_c_strategy, ZSTD_fast);
    ZSTD_CCtx_setParameter(context, ZSTD_c_targetLength, 64);
    ZSTD_CCtx_setParameter(context, literalCompression, huffman);
    ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
    return context;
}

// One pair a thread: making them costs more than using them.
ZSTD_CCtx& compressor() {
    thread_local const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(createCompressor(),
                                                                                    &ZSTD_freeCCtx);
    return *context;
}

ZSTD_DCtx& decompressor() {
    thread_local const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                                    &ZSTD_freeDCtx);
    if (!context) throw std::bad_alloc();
    return *context;
}

tl::unexpected<Error> damaged() {
    return fail(ErrorCode::Malformed, "the block does not decode to what it should hold");
}

bool allEqual(std::span<const std::byte> plane) {
    return std::equal(plane.begin() + 1, plane.end(), plane.begin());
}

void packPlane(std::span<const std::byte> plane, std::vector<std::byte>& block) {
    if (allEqual(plane)) {
        block.push_back(std::byte(PlaneKind::Constant));
        block.push_back(plane[0]);
        return;
    }
    // No room for more than a raw plane would take: then zstd gives up, and it is one.
    constexpr std::size_t head = sizeof(std::uint32_t);
    thread_local std::vector<std::byte> buffer(chunkRecords);
    const std::size_t room = plane.size() > head ? plane.size() - head : 0;
    const std::size_t packed =
        ZSTD_compress2(&compressor(), buffer.data() + head, room, plane.data(), plane.size());
    if (ZSTD_isError(packed)) {
        block.push_back(std::byte(PlaneKind::Raw));
        block.insert(block.end(), plane.begin(), plane.end());
        return;
    }
    block.push_back(std::byte(PlaneKind::Compressed));
    storeLe(buffer.data(), std::uint32_t(packed));
    block.insert(block.end(), buffer.begin(), buffer.begin() + std::ptrdiff_t(head + packed));
}

Expected<void> unpackPlane(std::span<const std::byte>& block, std::span<std::byte> plane) {
    if (block.size() < 2) return damaged();
    const auto kind = PlaneKind(block[0]);
    block = block.subspan(1);
    if (kind == PlaneKind::Constant) {
        std::fill(plane.begin(), plane.end(), block[0]);
        block = block.subspan(1);
        return {};
    }
    if (kind == PlaneKind::Raw) {
        if (block.size() < plane.size()) return damaged();
        std::copy_n(block.begin(), plane.size(), plane.begin());
        block = block.subspan(plane.size());
        return {};
    }
    if (kind != PlaneKind::Compressed || block.size() < sizeof(std::uint32_t)) return damaged();
    const std::size_t packed = loadLe<std::uint32_t>(block.data());
    block = block.subspan(sizeof(std::uint32_t));
    if (packed > block.size()) return damaged();
    const std::size_t got =
        ZSTD_decompressDCtx(&decompressor(), plane.data(), plane.size(), block.data(), packed);
    if (ZSTD_isError(got) || got != plane.size()) return damaged();
    block = block.subspan(packed);
    return {};
}

}  // namespace

void packPlanes(std::span<const std::byte> planes, std::size_t planeBytes, std::vector<std::byte>& block) {
    for (std::size_t at = 0; at < planes.size(); at += planeBytes)
        packPlane(planes.subspan(at, planeBytes), block);
}

Expected<void> unpackPlanes(std::span<const std::byte>& block, std::size_t planeBytes,
                            std::span<std::byte> planes) {
    for (std::size_t at = 0; at < planes.size(); at += planeBytes)
        if (auto ok = unpackPlane(block, planes.subspan(at, planeBytes)); !ok) return ok;
    return {};
}

}  // namespace scancast
