// Kernels that read and write whole rows of pixels: clear, test for hidden, resolve, eye-dome lighting,
// averages. Plain loops that the compiler vectorises. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/formulas.hpp"

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
        const std::int64_t first = static_cast<std::int64_t>(y) * out.stride;
        const IntW background = all(static_cast<std::int32_t>(out.background[y]));
        const IntW opaque = all(static_cast<std::int32_t>(0xff000000u));
        for (int x = 0; x < tile.width; x += wideLanes) {
            // Keys may be read beyond the row's end, into the guard band; pixels may not be written there.
            const int lanes = tile.width - x < wideLanes ? tile.width - x : wideLanes;
            IntW order, payload;
            loadKeys(keys + x, order, payload);
            const IntW rgba = order < infiniteOrder ? (payload | opaque) : background;
            const IntW depth = order < infiniteOrder ? order : all(infiniteOrder);
            if (lanes == wideLanes) {
                store(out.rgba + first + x, rgba);
                if (out.depth != nullptr) store(out.depth + first + x, depth);
            } else {
                storeSome(out.rgba + first + x, rgba, lanes);
                if (out.depth != nullptr) storeSome(out.depth + first + x, depth, lanes);
            }
        }
    }
}

void logDepth(const float* depth, float* out, int count) {
    const auto logs = [](FloatW d) {
        const IntW background = d > 3.4e38f;
        return background ? all(__builtin_inff()) : log2Of(background ? all(1.0f) : d);
    };
    int i = 0;
    for (; i + wideLanes <= count; i += wideLanes) store(out + i, logs(load<FloatW>(depth + i)));
    if (i < count) storeSome(out + i, logs(loadSome<FloatW>(depth + i, count - i)), count - i);
}

/// What the eight neighbours rise above a pixel, summed; a background neighbour, at +infinity, adds nothing.
inline FloatW riseOfNeighbours(const float* center, FloatW own, const EyeDome& e, int lanes) {
    FloatW sum{};
    for (int k = 0; k < 8; ++k) {
        const float* const place = center + e.offsets[k];
        const FloatW other = lanes == wideLanes ? load<FloatW>(place) : loadSome<FloatW>(place, lanes);
        sum += larger(own - other, all(0.0f));
    }
    return sum;
}

void eyeDome(const EyeDome& e) {
    for (int y = 0; y < e.height; ++y) {
        const float* const logs = e.logDepth + static_cast<std::int64_t>(y) * e.logStride;
        const std::uint32_t* const colors = e.rgba + static_cast<std::int64_t>(y) * e.stride;
        std::uint32_t* const out = e.out + static_cast<std::int64_t>(y) * e.outStride;
        for (int x = 0; x < e.width; x += wideLanes) {
            const int lanes = e.width - x < wideLanes ? e.width - x : wideLanes;
            const FloatW own = loadSome<FloatW>(logs + x, lanes);
            const IntW background = own > 3.4e38f;
            const FloatW sum = riseOfNeighbours(logs + x, background ? all(0.0f) : own, e, lanes);
            const FloatW shade = exp2Of(-(e.factor * sum));
            const IntW rgba = loadSome<IntW>(colors + x, lanes);
            storeSome(out + x, background ? rgba : shaded(rgba, shade), lanes);
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
