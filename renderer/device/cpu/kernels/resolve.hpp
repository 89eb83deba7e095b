// What splat passes left → planes of colour, depth and normal, where that is more than unpacking a key:
// samples looked up by their ordinals, means of sums. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/bends.hpp"
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

struct alignas(64) ResolvedPixels {
    std::uint32_t rgba[wideLanes], normals[wideLanes];
    float depth[wideLanes];
    /// From the sample's centre to the place that is seen: view space, cloud units.
    float awayX[wideLanes], awayY[wideLanes], awayZ[wideLanes];
    BendCodes bends;
    bool bent = false;  ///< any of them
};

/// Of a pixel of the picture, whose depth is known.
inline void bendPixel(const SplatPass& pass, const SplatRun& run, const SampleWords& words,
                      std::uint32_t code, std::int32_t px, std::int32_t py, int i, ResolvedPixels& out) {
    const float unitsPerPx = 1.0f / pass.pixelsPerUnit;
    const auto& m = run.toPicture;
    const float sx = static_cast<float>(static_cast<std::int32_t>(words[0] & 0xffff));
    const float sy = static_cast<float>(static_cast<std::int32_t>(words[0] >> 16));
    const float sz = static_cast<float>(static_cast<std::int32_t>(words[1] & 0xffff));
    const float across = m[0][0] * sx + (m[0][1] * sy + (m[0][2] * sz + m[0][3]));
    const float down = m[1][0] * sx + (m[1][1] * sy + (m[1][2] * sz + m[1][3]));
    const float depth = m[2][0] * sx + (m[2][1] * sy + (m[2][2] * sz + m[2][3]));
    const float spread = pass.perspective ? out.depth[i] : 1.0f;
    const float dx = (static_cast<float>(px) + 0.5f) - pass.centerX;
    const float dy = (static_cast<float>(py) + 0.5f) - pass.centerY;
    out.awayX[i] = (dx * spread - across) * unitsPerPx;
    out.awayY[i] = (down - dy * spread) * unitsPerPx;
    out.awayZ[i] = depth - out.depth[i];
    decodeBend(pass, run, code, i, out.bends);
    out.bent = true;
}

/// Normals of samples, turned into view space.
inline IntW viewNormalCodes(const SplatPass& pass, const ResolvedPixels& p) {
    const IntW codes = load<IntW>(p.normals);
    FloatW x, y, z;
    unpackSampleNormal(codes, x, y, z);
    const auto& r = pass.rotation;
    return packNormal(r[0][0] * x + (r[0][1] * y + r[0][2] * z), r[1][0] * x + (r[1][1] * y + r[1][2] * z),
                      r[2][0] * x + (r[2][1] * y + r[2][2] * z));
}

/// The same where the surface bends: n + k1 (away · e1) e1 + k2 (away · e2) e2.
inline IntW bentNormalCodes(const SplatPass& pass, const ResolvedPixels& p) {
    FloatW x, y, z;
    sampleNormal(load<IntW>(p.normals), x, y, z);
    const FloatW cloudX = x, cloudY = y, cloudZ = z;
    rotateToView(pass, x, y, z);
    const Bend b = bendOf(pass, cloudX, cloudY, cloudZ, x, y, z, p.bends);
    const FloatW ax = load<FloatW>(p.awayX), ay = load<FloatW>(p.awayY), az = load<FloatW>(p.awayZ);
    const FloatW turn1 = turnOf((ax * b.x1 + (ay * b.y1 + az * b.z1)) * b.k1);
    const FloatW turn2 = turnOf((ax * b.x2 + (ay * b.y2 + az * b.z2)) * b.k2);
    const IntW bent = packNormal(x + (turn1 * b.x1 + turn2 * b.x2), y + (turn1 * b.y1 + turn2 * b.y2),
                                 z + (turn1 * b.z1 + turn2 * b.z2));
    const IntW flat = (b.k1 == 0.0f) & (b.k2 == 0.0f);
    return flat | (load<IntW>(p.normals) == 0) ? viewNormalCodes(pass, p) : bent;
}

inline void lookUp(const SplatPass& pass, const SampleTable& table, const Key* keys, const Key* visible,
                   std::uint32_t background, std::int32_t px, std::int32_t py, int lanes,
                   ResolvedPixels& out) {
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
        if (pass.curved && curvature != 0) bendPixel(pass, run, words, curvature, px + i, py, i, out);
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
                   tile.visible != nullptr ? tile.visible + row + x : nullptr, out.background[y], tile.x + x,
                   tile.y + y, lanes, p);
            storeSome(out.rgba + first + x, load<IntW>(p.rgba), lanes);
            if (out.depth != nullptr) storeSome(out.depth + first + x, load<FloatW>(p.depth), lanes);
            if (out.normals != nullptr)
                storeSome(out.normals + first + x,
                          p.bent ? bentNormalCodes(pass, p) : viewNormalCodes(pass, p), lanes);
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
