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
                                 std::uint32_t beside, float depth) {
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
            return tableEntry(pass.ramp, curvatureIndex(pass, run, beside));
        case Coloring::Infrared:
            return toned(pass.ramp, infraredRgb(words[2], beside));
    }
    return 0;
}

inline std::uint32_t sampleColor(const SplatPass& pass, const SplatRun& run, const SampleWords& words,
                                 std::uint32_t beside, float depth) {
    const std::uint32_t color = sourceColor(pass, run, words, beside, depth);
    return pass.byIntensity ? brightened(pass, color, words[1]) : color;
}

/// Where the samples of a row of pixels lie; no run where there is none.
struct SamplePlaces {
    const SplatRun* runs[wideLanes];
    std::uint32_t at[wideLanes];
};

struct alignas(64) ResolvedPixels {
    std::uint32_t rgba[wideLanes], normals[wideLanes];
    float depth[wideLanes];
    /// Where samples' places are asked for: of the samples seen.
    std::uint32_t xy[wideLanes], zi[wideLanes], firstOrdinals[wideLanes];
    std::uint32_t curvatures[wideLanes];  ///< where normals turn, and 0 where they do not
    bool bent = false;                    ///< any of them
    float radii[wideLanes];               ///< where borders are smoothed; 0 = unknown
};

/// work(run, lanes, centres) for each run of the samples seen in these lanes; most are of one run or two.
template <class Work>
inline void inEachRun(const SamplePlaces& places, const ResolvedPixels& p, IntW left, const Work& work) {
    const IntW xy = load<IntW>(p.xy), zi = load<IntW>(p.zi), ordinals = load<IntW>(p.firstOrdinals);
    for (int i = 0; i < wideLanes; ++i) {
        if (left[i] == 0) continue;
        const SplatRun& run = *places.runs[i];
        const IntW here = left & (ordinals == static_cast<std::int32_t>(run.firstOrdinal));
        work(run, here, centresOf(run, xy, zi));
        left &= ~here;
        if (!anyOf<wideLanes>(left)) break;
    }
}

/// In the codes of Owners.
inline IntW placeCodes(FloatW away) {
    const FloatW code = away * placeSteps + (placeMiddle + 0.5f);
    return toInt(smaller(larger(code, all(0.0f)), all(lastPlace)));
}

/// Whose sprites pixels of a row of the picture show, placed and sized as project() and placeBlock() of project.hpp do it.
inline void storeOwners(const SplatPass& pass, const SamplePlaces& places, const ResolvedPixels& p,
                        std::int32_t px, std::int32_t py, const Owners& out, std::int64_t at, int lanes) {
    const FloatW depth = load<FloatW>(p.depth), radii = load<FloatW>(p.radii);
    const FloatW column = toFloat(toInt(laneNumbers<wideLanes>()) + px) + 0.5f;
    const float row = static_cast<float>(py) + 0.5f;
    IntW codes = all(0);
    FloatW halves = all(0.0f);
    // Lanes beyond the row's end have no depth.
    const IntW shown = (depth > 0.0f) & (depth < __builtin_inff());
    inEachRun(places, p, shown, [&](const SplatRun& run, IntW here, const Centres& c) {
        const FloatW inverse = pass.perspective ? 1.0f / c.depth : all(1.0f);
        const FloatW x = pass.centerX + c.across * inverse, y = pass.centerY + c.down * inverse;
        const FloatW ratio = radii > 0.0f ? radii * run.ratioUnit : all(1.0f);
        halves = here ? 0.5f * sizeOfSprites(pass, run, ratio, inverse) : halves;
        codes = here ? placeCodes(column - x) | placeCodes(row - y) << 16 : codes;
    });
    storeSome(out.places + at, codes, lanes);
    storeSome(out.halves + at, halves, lanes);
    storeSome(out.orders + at, depth, lanes);
    storeSome(out.colors + at, load<IntW>(p.rgba), lanes);
}

/// From samples' centres to the places that are seen, in view space, cloud units; and how the surface bends there.
struct BentPlaces {
    FloatW awayX, awayY, awayZ, perUnit;
    BendCodes bends;
};

/// Pixels of a row of the picture, whose depths are known.
inline BentPlaces bentPlaces(const SplatPass& pass, const SamplePlaces& places, const ResolvedPixels& p,
                             std::int32_t px, std::int32_t py) {
    BentPlaces out{};
    for (int i = 0; i < wideLanes; ++i) decodeBend(pass, p.curvatures[i], i, out.bends);
    const FloatW depth = load<FloatW>(p.depth), spread = pass.perspective ? depth : all(1.0f);
    const FloatW dx = (toFloat(toInt(laneNumbers<wideLanes>()) + px) + 0.5f) - pass.centerX;
    const FloatW dy = all((static_cast<float>(py) + 0.5f) - pass.centerY);
    const FloatW right = dx * spread, below = dy * spread;
    const float unitsPerPx = 1.0f / pass.pixelsPerUnit;
    inEachRun(places, p, load<IntW>(p.curvatures) != 0,
              [&](const SplatRun& run, IntW here, const Centres& c) {
                  out.awayX = here ? (right - c.across) * unitsPerPx : out.awayX;
                  out.awayY = here ? (c.down - below) * unitsPerPx : out.awayY;
                  out.awayZ = here ? c.depth - depth : out.awayZ;
                  out.perUnit = here ? all(bendsPerUnit(run)) : out.perUnit;
              });
    return out;
}

/// Normals of samples, turned into view space.
inline IntW viewNormalCodes(const SplatPass& pass, const ResolvedPixels& p) {
    FloatW x, y, z;
    unpackSampleNormal(load<IntW>(p.normals), x, y, z);
    rotateToView(pass, x, y, z);
    return packNormal(x, y, z);
}

/// The same where the surface bends: n + k1 (away · e1) e1 + k2 (away · e2) e2.
inline IntW bentNormalCodes(const SplatPass& pass, const SamplePlaces& places, const ResolvedPixels& p,
                            std::int32_t px, std::int32_t py) {
    const BentPlaces at = bentPlaces(pass, places, p, px, py);
    FloatW x, y, z;
    sampleNormal(load<IntW>(p.normals), x, y, z);
    const FloatW cloudX = x, cloudY = y, cloudZ = z;
    rotateToView(pass, x, y, z);
    const Bend b = bendOf(pass, cloudX, cloudY, cloudZ, x, y, z, at.bends, at.perUnit);
    const FloatW turn1 = turnOf((at.awayX * b.x1 + (at.awayY * b.y1 + at.awayZ * b.z1)) * b.k1);
    const FloatW turn2 = turnOf((at.awayX * b.x2 + (at.awayY * b.y2 + at.awayZ * b.z2)) * b.k2);
    const IntW bent = packNormal(x + (turn1 * b.x1 + turn2 * b.x2), y + (turn1 * b.y1 + turn2 * b.y2),
                                 z + (turn1 * b.z1 + turn2 * b.z2));
    const IntW flat = (b.k1 == 0.0f) & (b.k2 == 0.0f);
    return flat | (load<IntW>(p.normals) == 0) ? viewNormalCodes(pass, p) : bent;
}

/// Asks for the samples on the way, so that they are at hand when they are looked up.
inline void findSamples(const SplatPass& pass, const SampleTable& table, const Key* keys, int lanes,
                        SamplePlaces& out) {
    for (int i = 0; i < lanes; ++i) {
        out.runs[i] = nullptr;
        if (static_cast<std::int32_t>(keys[i] >> 32) >= infiniteOrder) continue;
        const std::uint32_t ordinal = static_cast<std::uint32_t>(keys[i]);
        const SplatRun& run = runOf(table, ordinal);
        if (run.samples == nullptr) continue;  // somebody else's (pass_reduction.hpp)
        const std::uint32_t at = ordinal - run.firstOrdinal;
        __builtin_prefetch(run.samples + at);
        if (pass.curved && run.beside != nullptr) __builtin_prefetch(run.beside + at);
        out.runs[i] = &run;
        out.at[i] = at;
    }
}

inline void lookUp(const SplatPass& pass, const SamplePlaces& places, const Key* depths,
                   std::uint32_t background, bool owners, int lanes, ResolvedPixels& out) {
    for (int i = 0; i < lanes; ++i) {
        out.rgba[i] = background;
        out.depth[i] = __builtin_inff();
        out.normals[i] = 0;
        if (places.runs[i] == nullptr) continue;
        const std::int32_t depthBits = static_cast<std::int32_t>(depths[i] >> 32);
        __builtin_memcpy(&out.depth[i], &depthBits, 4);
        const SplatRun& run = *places.runs[i];
        const SampleWords& words = run.samples[places.at[i]];
        const std::uint32_t beside = besideAt(run, places.at[i]);
        out.rgba[i] = sampleColor(pass, run, words, beside, out.depth[i]) | 0xff000000u;
        out.normals[i] = words[3] & 0xffff;
        if (!pass.curved && !owners) continue;
        out.xy[i] = words[0];
        out.zi[i] = words[1];
        out.firstOrdinals[i] = run.firstOrdinal;
        if (owners && pass.radii != nullptr) out.radii[i] = pass.radii[(words[3] >> 16) & 255];
        if (!pass.curved) continue;
        out.curvatures[i] = beside & curvatureBits;
        out.bent |= out.curvatures[i] != 0;
    }
}

void resolveSamples(const SplatPass& pass, const SampleTable& table, const KeyTile& tile,
                    const PixelTile& out) {
    const Key* const depths = tile.visible != nullptr ? tile.visible : tile.keys;
    const bool owners = out.owners.places != nullptr;
    const auto lanesAt = [&](int x) { return tile.width - x < wideLanes ? tile.width - x : wideLanes; };
    SamplePlaces places[2];
    for (int y = 0; y < tile.height; ++y) {
        const std::int64_t row = static_cast<std::int64_t>(y) * tile.stride;
        const std::int64_t first = static_cast<std::int64_t>(y) * out.stride;
        findSamples(pass, table, tile.keys + row, lanesAt(0), places[0]);
        for (int x = 0, turn = 0; x < tile.width; x += wideLanes, turn ^= 1) {
            if (x + wideLanes < tile.width)
                findSamples(pass, table, tile.keys + row + x + wideLanes, lanesAt(x + wideLanes),
                            places[turn ^ 1]);
            const int lanes = lanesAt(x);
            ResolvedPixels p{};
            lookUp(pass, places[turn], depths + row + x, out.background[y], owners, lanes, p);
            storeSome(out.rgba + first + x, load<IntW>(p.rgba), lanes);
            if (out.depth != nullptr) storeSome(out.depth + first + x, load<FloatW>(p.depth), lanes);
            if (out.normals != nullptr)
                storeSome(out.normals + first + x,
                          p.bent ? bentNormalCodes(pass, places[turn], p, tile.x + x, tile.y + y)
                                 : viewNormalCodes(pass, p),
                          lanes);
            if (owners)
                storeOwners(pass, places[turn], p, tile.x + x, tile.y + y, out.owners,
                            std::int64_t{y} * out.owners.stride + x, lanes);
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
