// Kernels that read and write whole rows of pixels: clear, test for hidden, resolve, eye-dome lighting,
// averages. Plain loops that the compiler vectorises. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/vectors.hpp"

namespace scancast::cpu {
namespace {

void clear(const KeyTile& tile) {
    for (int y = 0; y < tile.height; ++y) {
        Key* const row = tile.keys + static_cast<std::int64_t>(y) * tile.stride;
        for (int x = 0; x < tile.width; ++x) row[x] = emptyKey;
    }
}

bool hidden(const KeyTile& tile, int x0, int y0, int x1, int y1, std::int32_t orderBits) {
    const Key bound = static_cast<Key>(orderBits) << 32;
    for (int y = y0; y < y1; ++y) {
        const Key* const row = tile.keys + static_cast<std::int64_t>(y) * tile.stride;
        for (int x = x0; x < x1;) {
            // A hole is soon found: look for one every few pixels.
            const int end = x1 - x < 32 ? x1 : x + 32;
            Key open = 0;
            for (; x < end; ++x) open |= row[x] >= bound ? 1 : 0;
            if (open != 0) return false;
        }
    }
    return true;
}

void resolve(const KeyTile& tile, const PixelTile& out) {
    for (int y = 0; y < tile.height; ++y) {
        const Key* const keys = tile.keys + static_cast<std::int64_t>(y) * tile.stride;
        std::uint32_t* const rgba = out.rgba + static_cast<std::int64_t>(y) * out.stride;
        const std::uint32_t background = out.background[y];
        for (int x = 0; x < tile.width; ++x) {
            const bool covered = keys[x] < static_cast<Key>(infiniteOrder) << 32;
            const std::uint32_t color = static_cast<std::uint32_t>(keys[x]) | 0xff000000u;
            rgba[x] = covered ? color : background;
        }
        if (out.depth == nullptr) continue;
        float* const depth = out.depth + static_cast<std::int64_t>(y) * out.stride;
        for (int x = 0; x < tile.width; ++x) {
            const std::int32_t order = static_cast<std::int32_t>(keys[x] >> 32);
            const std::int32_t bits = order < infiniteOrder ? order : infiniteOrder;
            __builtin_memcpy(&depth[x], &bits, sizeof bits);
        }
    }
}

/// log2 by halving to [sqrt(1/2), sqrt(2)) and the series of artanh; absolute error below 2 ulp of the
/// result.
inline float log2Of(float value) {
    std::int32_t bits;
    __builtin_memcpy(&bits, &value, sizeof bits);
    const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;
    const std::int32_t mantissaBits = bits - exponent * (1 << 23);
    float m;
    __builtin_memcpy(&m, &mantissaBits, sizeof m);
    const float s = (m - 1.0f) / (m + 1.0f);
    const float s2 = s * s;
    const float series = 0.41219858f + s2 * 0.32059890f;
    const float log2m = s * (2.88539008f + s2 * (0.96179669f + s2 * (0.57707802f + s2 * series)));
    return static_cast<float>(exponent) + log2m;
}

/// 2^x for x ≤ 0, by Taylor's series on [-1/2, 1/2]; relative error below 3e-7, 0 below -120.
inline float exp2Of(float x) {
    const float bounded = x < -120.0f ? -120.0f : x;
    const float whole = __builtin_floorf(bounded + 0.5f);
    const float f = bounded - whole;
    const float tail = 0.0013333558f + f * 0.00015403530f;
    const float p =
        1.0f + f * (0.69314718f + f * (0.24022651f + f * (0.055504109f + f * (0.0096181291f + f * tail))));
    const std::int32_t bits = (static_cast<std::int32_t>(whole) + 127) * (1 << 23);
    float scale;
    __builtin_memcpy(&scale, &bits, sizeof scale);
    return x < -120.0f ? 0.0f : p * scale;
}

void logDepth(const float* depth, float* out, int count) {
    for (int i = 0; i < count; ++i) {
        const bool background = depth[i] > 3.4e38f;
        const float log = log2Of(background ? 1.0f : depth[i]);
        out[i] = background ? __builtin_inff() : log;
    }
}

void eyeDome(const EyeDome& e) {
    for (int y = 0; y < e.height; ++y) {
        const float* const center = e.logDepth + static_cast<std::int64_t>(y) * e.logStride;
        const std::uint32_t* const rgba = e.rgba + static_cast<std::int64_t>(y) * e.stride;
        std::uint32_t* const out = e.out + static_cast<std::int64_t>(y) * e.outStride;
        for (int x = 0; x < e.width; ++x) {
            float sum = 0;
            const float own = center[x];
            const bool background = own > 3.4e38f;
            const float from = background ? 0.0f : own;
            for (int k = 0; k < 8; ++k) {
                // A background neighbour lies at +infinity: it adds nothing.
                const float rise = from - center[x + e.offsets[k]];
                sum += rise > 0.0f ? rise : 0.0f;
            }
            const float shade = exp2Of(-(e.factor * sum));
            std::uint32_t shaded = rgba[x] & 0xff000000u;
            for (int c = 0; c < 24; c += 8) {
                const float channel = static_cast<float>(static_cast<std::int32_t>(rgba[x] >> c & 255));
                shaded |= static_cast<std::uint32_t>(static_cast<std::int32_t>(channel * shade + 0.5f)) << c;
            }
            out[x] = background ? rgba[x] : shaded;
        }
    }
}

void accumulate(const std::uint8_t* rgba, std::uint16_t* sums, int bytes) {
    for (int i = 0; i < bytes; ++i) sums[i] = static_cast<std::uint16_t>(sums[i] + rgba[i]);
}

void average(const std::uint16_t* sums, std::uint8_t* rgba, int pixels, int frames) {
    for (int i = 0; i < pixels; ++i) {
        const std::uint16_t* const sum = sums + 4 * i;
        std::uint8_t* const out = rgba + 4 * i;
        const int covered = sum[3] / 255;
        const int divisor = covered > 0 ? covered : 1;
        for (int c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>((sum[c] + divisor / 2) / divisor);
        out[3] = static_cast<std::uint8_t>((sum[3] + frames / 2) / frames);
    }
}

}  // namespace
}  // namespace scancast::cpu
