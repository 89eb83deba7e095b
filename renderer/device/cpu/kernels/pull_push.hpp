// Pull-push: colour and depth for pixels that show nothing, from the visible ones around.
// docs/spec/pyramid.md §5, after Kraus, "The pull-push algorithm revisited", 2009. Part of kernels.cpp.
//
// A pixel's weight is 0 or 1, and min(1, sum of four) keeps it so on all levels: a texel is known, the mean
// of its known children, or it is not (depth +infinity).
#pragma once

#include "renderer/device/cpu/kernels/texels.hpp"

namespace scancast::cpu {
namespace {

inline constexpr int fillPlanes = 4;

/// depth, red, green, blue.
struct Filling {
    FloatW v[fillPlanes];
};

struct PlanesOf {
    float* p[fillPlanes];
    explicit PlanesOf(const FillLevel& l) : p{l.depth, l.red, l.green, l.blue} {}
};

/// Mean of the children that are known.
inline Filling meanOf(const Four<FloatW> (&children)[fillPlanes]) {
    const Four<FloatW>& depth = children[0];
    Filling sum{};
    FloatW count{};
    for (int i = 0; i < 4; ++i) {
        const IntW taken = depth.v[i] < finiteDepths;
        count += taken ? all(1.0f) : all(0.0f);
        for (int k = 0; k < fillPlanes; ++k) sum.v[k] += taken ? children[k].v[i] : all(0.0f);
    }
    const FloatW share = 1.0f / (count > 0.0f ? count : all(1.0f));
    for (FloatW& v : sum.v) v = v * share;
    sum.v[0] = count > 0.0f ? sum.v[0] : all(infinity);
    return sum;
}

inline void storeFilling(const PlanesOf& out, std::int64_t row, int x, int width, const Filling& f) {
    for (int k = 0; k < fillPlanes; ++k) storeInside(out.p[k] + row, x, width, f.v[k]);
}

/// The first and last texel of a row once more, beside it: push looks there.
inline void extendRow(float* row, int width) {
    row[-1] = row[0];
    row[width] = row[width - 1];
}

inline FloatW channelOf(IntW rgba, int shift) {
    return toFloat((rgba >> shift) & 255);
}

/// Two vectors of colours, as far as the row has them.
struct ColorPair {
    IntW first, second;
    ColorPair(const std::uint32_t* row, int x, int width) {
        const auto lanes = [&](int from) {
            return width - from < 0 ? 0 : width - from < wideLanes ? width - from : wideLanes;
        };
        first = loadSome<IntW>(row + (lanes(x) > 0 ? x : 0), lanes(x));
        second = loadSome<IntW>(row + (lanes(x + wideLanes) > 0 ? x + wideLanes : 0), lanes(x + wideLanes));
    }
};

void pullPicture(const FillPicture& picture, const FillLevel& out, int y0, int y1) {
    const PlanesOf planes(out);
    for (int y = y0; y < y1; ++y) {
        const std::int64_t row = rowOf(out.stride, y);
        for (int x = 0; x < out.width; x += wideLanes) {
            Four<FloatW> children[fillPlanes];
            for (int half = 0; half < 2; ++half) {
                const int fineY = 2 * y + half;
                const int colorY = fineY < picture.height ? fineY : picture.height - 1;
                const float* const depths = picture.points + rowOf(picture.pointStride, fineY) + 2 * x;
                const std::uint8_t* const labels = picture.labels + rowOf(picture.labelStride, fineY) + 2 * x;
                const auto shown = [&](int at) {
                    const IntW visible = loadLabels(labels + at) == std::int32_t{foregroundLabel};
                    return visible ? load<FloatW>(depths + at) : all(infinity);
                };
                const FloatW a = shown(0), b = shown(wideLanes);
                const ColorPair colors(picture.rgba + rowOf(picture.stride, colorY), 2 * x, picture.width);
                const IntW left = evens(colors.first, colors.second),
                           right = odds(colors.first, colors.second);
                children[0].v[2 * half] = evens(a, b);
                children[0].v[2 * half + 1] = odds(a, b);
                for (int k = 1; k < fillPlanes; ++k) {
                    children[k].v[2 * half] = channelOf(left, 8 * (k - 1));
                    children[k].v[2 * half + 1] = channelOf(right, 8 * (k - 1));
                }
            }
            storeFilling(planes, row, x, out.width, meanOf(children));
        }
        for (float* const plane : planes.p) extendRow(plane + row, out.width);
    }
}

void pull(const FillLevel& fine, const FillLevel& out, int y0, int y1) {
    const PlanesOf from(fine), planes(out);
    for (int y = y0; y < y1; ++y) {
        const std::int64_t row = rowOf(out.stride, y), top = rowOf(fine.stride, 2 * y);
        // Below the last row, as right of the last texel, nothing is known.
        const bool below = 2 * y + 1 < fine.height;
        for (int x = 0; x < out.width; x += wideLanes) {
            Four<FloatW> children[fillPlanes];
            for (int k = 0; k < fillPlanes; ++k) {
                const float* const p = from.p[k] + top + 2 * x;
                children[k] = loadFours<FloatW>(p, below ? p + fine.stride : p);
            }
            const FloatW right = toFloat((laneIndices() + x) * 2 + 1);
            const IntW beside = right < static_cast<float>(fine.width);
            for (int i = 0; i < 4; ++i) {
                const IntW exists = (i & 1) != 0 ? beside : all(-1);
                const IntW known = i < 2 || below ? exists : all(0);
                children[0].v[i] = known ? children[0].v[i] : all(infinity);
            }
            storeFilling(planes, row, x, out.width, meanOf(children));
        }
        for (float* const plane : planes.p) extendRow(plane + row, out.width);
    }
}

/// Texels of the coarser level around a row of finer ones: that which covers each, and the nearest beside it.
struct Beside {
    FloatW covering, other;
};

inline Beside besideOf(const float* row, int x) {
    const FloatW v = load<FloatW>(row + x / 2 - 1);
#if SCANCAST_SIMD_LEVEL >= 3
    return {__builtin_shufflevector(v, v, 1, 1, 2, 2, 3, 3, 4, 4),
            __builtin_shufflevector(v, v, 0, 2, 1, 3, 2, 4, 3, 5)};
#else
    return {__builtin_shufflevector(v, v, 1, 1, 2, 2), __builtin_shufflevector(v, v, 0, 2, 1, 3)};
#endif
}

/// Interpolates a coarser level with weights 9, 3, 3, 1.
struct Interpolation {
    PlanesOf planes;
    std::int64_t near, far;  ///< rows: the one that covers the finer row, and the next nearest

    Interpolation(const FillLevel& coarse, int y) : planes(coarse) {
        const int covering = y >> 1, other = (y & 1) != 0 ? covering + 1 : covering - 1;
        const int last = coarse.height - 1;
        near = rowOf(coarse.stride, covering);
        far = rowOf(coarse.stride, other < 0 ? 0 : other > last ? last : other);
    }

    Filling at(int x) const {
        Filling out;
        for (int k = 0; k < fillPlanes; ++k) {
            const Beside a = besideOf(planes.p[k] + near, x), b = besideOf(planes.p[k] + far, x);
            out.v[k] = (a.covering * 9.0f + (a.other + b.covering) * 3.0f + b.other) * 0.0625f;
        }
        return out;
    }
};

void push(const FillLevel& coarse, const FillLevel& fine, int y0, int y1) {
    const PlanesOf planes(fine);
    for (int y = y0; y < y1; ++y) {
        const Interpolation filling(coarse, y);
        const std::int64_t row = rowOf(fine.stride, y);
        for (int x = 0; x < fine.width; x += wideLanes) {
            const IntW unknown = load<FloatW>(planes.p[0] + row + x) > finiteDepths;
            if (bitsOf(unknown) == 0) continue;
            const Filling f = filling.at(x);
            for (int k = 0; k < fillPlanes; ++k) {
                float* const plane = planes.p[k] + row;
                storeInside(plane, x, fine.width, unknown ? f.v[k] : load<FloatW>(plane + x));
            }
        }
        for (float* const plane : planes.p) extendRow(plane + row, fine.width);
    }
}

inline IntW rgbaOf(const Filling& f) {
    IntW rgba = all(static_cast<std::int32_t>(0xff000000u));
    for (int k = 1; k < fillPlanes; ++k) rgba |= toInt(f.v[k] + 0.5f) << (8 * (k - 1));
    return rgba;
}

void pushPicture(const FillLevel& coarse, const FillPicture& picture, int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
        const Interpolation filling(coarse, y);
        const std::uint8_t* const labels = picture.labels + rowOf(picture.labelStride, y);
        std::uint32_t* const colors = picture.rgba + rowOf(picture.stride, y);
        float* const depths = picture.depth + rowOf(picture.stride, y);
        for (int x = 0; x < picture.width; x += wideLanes) {
            const IntW empty = loadLabels(labels + x) == std::int32_t{hiddenLabel};
            if (bitsOf(empty) == 0) continue;
            const int lanes = picture.width - x < wideLanes ? picture.width - x : wideLanes;
            const Filling f = filling.at(x);
            const IntW rgba = empty ? rgbaOf(f) : loadSome<IntW>(colors + x, lanes);
            const FloatW depth = empty ? f.v[0] : loadSome<FloatW>(depths + x, lanes);
            storeSome(colors + x, rgba, lanes);
            storeSome(depths + x, depth, lanes);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
