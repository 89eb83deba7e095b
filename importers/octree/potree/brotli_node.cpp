#include "importers/octree/potree/brotli_node.hpp"

#include <brotli/decode.h>
#include <fmt/format.h>

#include <cstring>
#include <memory>
#include <new>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

struct FreeBrotli {
    void operator()(BrotliDecoderState* state) const { BrotliDecoderDestroyInstance(state); }
};

/// Bits 0, 3, 6 … 45 as bits 0 … 15.
std::uint32_t everyThird(std::uint64_t bits) {
    bits &= 0x2492'4924'9249;
    bits = (bits | bits >> 2) & 0x0c30'c30c'30c3;
    bits = (bits | bits >> 4) & 0x00f0'0f00'f00f;
    bits = (bits | bits >> 8) & 0x0000'ff00'00ff;
    return static_cast<std::uint32_t>((bits | bits >> 16) & 0xffff);
}

/// The upper halves of the three numbers come first.
void positionOf(const std::byte* code, std::byte* to) {
    const auto upper = loadLe<std::uint64_t>(code), lower = loadLe<std::uint64_t>(code + 8);
    for (int axis = 0; axis < 3; ++axis)
        storeLe(to + 4 * axis, everyThird(upper >> axis) << 16 | everyThird(lower >> axis));
}

void colorOf(const std::byte* code, std::byte* to) {
    const auto bits = loadLe<std::uint64_t>(code);
    for (int i = 0; i < 3; ++i) storeLe(to + 2 * i, static_cast<std::uint16_t>(everyThird(bits >> i)));
}

}  // namespace

std::uint64_t brotliPointBytes(const PotreeLayout& layout) {
    std::uint64_t bytes = 0;
    for (const auto& attribute : layout.attributes) bytes += attribute.codeBytes();
    return bytes;
}

Expected<std::vector<std::byte>> unpackBrotli(std::span<const std::byte> compressed, std::uint64_t bytes,
                                              const std::string& node) {
    const std::unique_ptr<BrotliDecoderState, FreeBrotli> state(
        BrotliDecoderCreateInstance(nullptr, nullptr, nullptr));
    if (!state) throw std::bad_alloc();
    std::vector<std::byte> unpacked(bytes);
    std::size_t in = compressed.size(), out = unpacked.size();
    const auto* from = reinterpret_cast<const std::uint8_t*>(compressed.data());
    auto* to = reinterpret_cast<std::uint8_t*>(unpacked.data());
    const auto result = BrotliDecoderDecompressStream(state.get(), &in, &from, &out, &to, nullptr);
    if (result == BROTLI_DECODER_RESULT_SUCCESS && out == 0) return unpacked;
    switch (result) {
        case BROTLI_DECODER_RESULT_SUCCESS:
            return fail(ErrorCode::Malformed, fmt::format("{} has {} bytes; its points need {}", node,
                                                          grouped(bytes - out), grouped(bytes)));
        case BROTLI_DECODER_RESULT_NEEDS_MORE_OUTPUT:
            return fail(ErrorCode::Malformed,
                        fmt::format("{} has more bytes than its points need ({})", node, grouped(bytes)));
        case BROTLI_DECODER_RESULT_NEEDS_MORE_INPUT:
            return fail(ErrorCode::Truncated, fmt::format("{} ends early: it is cut off, or damaged", node));
        default:
            return fail(ErrorCode::Malformed,
                        fmt::format("{} cannot be decompressed: {}", node,
                                    BrotliDecoderErrorString(BrotliDecoderGetErrorCode(state.get()))));
    }
}

void brotliRecords(const PotreeLayout& layout, std::span<const std::byte> unpacked, std::uint64_t points,
                   std::uint64_t first, std::span<std::byte> records) {
    const std::size_t recordBytes = layout.points.bytes();
    const auto count = records.size() / recordBytes;
    const auto* base = unpacked.data();
    for (const auto& attribute : layout.attributes) {
        const std::size_t stride = attribute.codeBytes();
        const auto* from = base + first * stride;
        auto* to = records.data() + attribute.at;
        for (std::size_t i = 0; i < count; ++i, from += stride, to += recordBytes) {
            if (attribute.code == PotreeCode::Position)
                positionOf(from, to);
            else if (attribute.code == PotreeCode::Color)
                colorOf(from, to);
            else
                std::memcpy(to, from, stride);
        }
        base += points * stride;
    }
}

}  // namespace scancast::import_octree
