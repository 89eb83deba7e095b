// What splat passes left → planes of colour, depth and normal, where that is more than unpacking a key:
// samples looked up by their ordinals, means of sums. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/normal_plane.hpp"
#include "renderer/device/cpu/kernels/project.hpp"
#include "renderer/device/cpu/kernels/vectors.hpp"

namespace scancast::cpu {
namespace {

inline const SplatRun& runOf(const SampleTable& table, std::uint32_t ordinal) {
    std::uint32_t i = table.runAt[ordinal >> table.shift];
    while (i + 1 < table.count && table.runs[i + 1].firstOrdinal <= ordinal) ++i;
    return table.runs[i];
}

/// As colorize() does for a block, but for the depth, which is the pixel's.
inline std::uint32_t sourceColor(const SplatPass& pass, const SplatRun& run, const SampleWords& words,
                                 std::uint32_t curvature, float depth) {
    switch (pass.coloring) {
        case Coloring::Rgb:
            return words[2] & 0xffffff;
        case Coloring::PerRun:
            return run.color;
        case Coloring::Intensity: {
            const float value = static_cast<float>(static_cast<std::int32_t>(words[1] >> 16));
            return tableEntry(pass.ramp, (value - pass.colorLow) * pass.colorScale);
        }
        case Coloring::Elevation: {
            const float z = static_cast<float>(static_cast<std::int32_t>(words[1] & 0xffff));
            return tableEntry(pass.ramp, z * run.indexStep + run.indexBase);
        }
        case Coloring::Classification:
            return pass.ramp[words[2] >> 24];
        case Coloring::Normal:
            return pass.normals[words[3] & 0xffff];
        case Coloring::Depth:
            return tableEntry(pass.ramp, (depth - pass.colorLow) * pass.colorScale);
        case Coloring::Toned:
            return toned(pass.ramp, words[2]);
        case Coloring::Curvature:
            return tableEntry(pass.ramp, curvatureIndex(pass, run, curvature));
    }
    return 0;
}

inline std::uint32_t sampleColor(const SplatPass& pass, const SplatRun& run, const SampleWords& words,
                                 std::uint32_t curvature, float depth) {
    const std::uint32_t color = sourceColor(pass, run, words, curvature, depth);
    return pass.byIntensity ? brightened(pass, color, words[1]) : color;
}

/// Normals of samples, turned into view space.
inline IntW viewNormalCodes(const SplatPass& pass, IntW codes) {
    FloatW x, y, z;
    unpackSampleNormal(codes, x, y, z);
    const auto& r = pass.rotation;
    return packNormal(r[0][0] * x + (r[0][1] * y + r[0][2] * z), r[1][0] * x + (r[1][1] * y + r[1][2] * z),
                      r[2][0] * x + (r[2][1] * y + r[2][2] * z));
}

struct alignas(64) ResolvedPixels {
    std::uint32_t rgba[wideLanes], normals[wideLanes];
    float depth[wideLanes];
};

inline void lookUp(const SplatPass& pass, const SampleTable& table, const Key* keys, const Key* visible,
                   std::uint32_t background, int lanes, ResolvedPixels& out) {
    for (int i = 0; i < lanes; ++i) {
        const std::int32_t order = static_cast<std::int32_t>(keys[i] >> 32);
        out.rgba[i] = background;
        out.depth[i] = __builtin_inff();
        out.normals[i] = 0;
        if (order >= infiniteOrder) continue;
        const std::int32_t depthBits =
            visible != nullptr ? static_cast<std::int32_t>(visible[i] >> 32) : order;
        __builtin_memcpy(&out.depth[i], &depthBits, 4);
        const std::uint32_t ordinal = static_cast<std::uint32_t>(keys[i]);
        const SplatRun& run = runOf(table, ordinal);
        const std::uint32_t at = ordinal - run.firstOrdinal;
        const SampleWords& words = run.samples[at];
        const std::uint32_t curvature = run.curvatures != nullptr ? run.curvatures[at] : 0;
        out.rgba[i] = sampleColor(pass, run, words, curvature, out.depth[i]) | 0xff000000u;
        out.normals[i] = words[3] & 0xffff;
    }
}

void resolveSamples(const SplatPass& pass, const SampleTable& table, const KeyTile& tile,
                    const PixelTile& out) {
    for (int y = 0; y < tile.height; ++y) {
        const std::int64_t row = static_cast<std::int64_t>(y) * tile.stride;
        const std::int64_t first = static_cast<std::int64_t>(y) * out.stride;
        for (int x = 0; x < tile.width; x += wideLanes) {
            const int lanes = tile.width - x < wideLanes ? tile.width - x : wideLanes;
            ResolvedPixels p{};
            lookUp(pass, table, tile.keys + row + x,
                   tile.visible != nullptr ? tile.visible + row + x : nullptr, out.background[y], lanes, p);
            storeSome(out.rgba + first + x, load<IntW>(p.rgba), lanes);
            if (out.depth != nullptr) storeSome(out.depth + first + x, load<FloatW>(p.depth), lanes);
            if (out.normals != nullptr)
                storeSome(out.normals + first + x, viewNormalCodes(pass, load<IntW>(p.normals)), lanes);
        }
    }
}

/// Sums of one plane, as floats: of numbers up to 2^32 the eight bits that a picture has stay exact.
inline FloatW sumsAt(const KeyTile& tile, const std::int64_t* wide, int plane, std::int64_t offset) {
    const std::int64_t place = plane * tile.planeSize + offset;
    const IntW narrow = load<IntW>(tile.sums + place);
    // Σw·c may use the sign bit; normals are signed.
    const bool isSigned = plane >= colorPlanes;
    FloatW out;
    for (int i = 0; i < wideLanes; ++i) {
        const std::int64_t value =
            isSigned ? std::int64_t{narrow[i]} : std::int64_t{static_cast<std::uint32_t>(narrow[i])};
        out[i] = static_cast<float>(value + (wide != nullptr ? wide[place + i] : 0));
    }
    return out;
}

void resolveSums(const KeyTile& tile, const std::int64_t* wide, const PixelTile& out) {
    const IntW opaque = all(static_cast<std::int32_t>(0xff000000u));
    for (int y = 0; y < tile.height; ++y) {
        const std::int64_t row = static_cast<std::int64_t>(y) * tile.stride;
        const std::int64_t first = static_cast<std::int64_t>(y) * out.stride;
        for (int x = 0; x < tile.width; x += wideLanes) {
            const int lanes = tile.width - x < wideLanes ? tile.width - x : wideLanes;
            IntW order, payload;
            loadKeys(tile.keys + row + x, order, payload);
            const FloatW weight = sumsAt(tile, wide, 0, row + x);
            const IntW blended = (order < infiniteOrder) & (weight > 0.0f);
            const FloatW inverse = 1.0f / (blended ? weight : all(1.0f));
            IntW rgba = opaque;
            for (int c = 0; c < 3; ++c)
                rgba |= toInt(sumsAt(tile, wide, 1 + c, row + x) * inverse + 0.5f) << (8 * c);
            const IntW before = loadSome<IntW>(out.rgba + first + x, lanes);
            storeSome(out.rgba + first + x, blended ? rgba : before, lanes);
            if (out.normals == nullptr) continue;
            const IntW mean = packNormal(sumsAt(tile, wide, 4, row + x), sumsAt(tile, wide, 5, row + x),
                                         sumsAt(tile, wide, 6, row + x));
            const IntW own = loadSome<IntW>(out.normals + first + x, lanes);
            storeSome(out.normals + first + x, blended & (mean != 0) ? mean : own, lanes);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
