// First half of a splat pass: samples → places on the picture, depths and colours, a block at a time, as
// structures of arrays that the compiler vectorises. Part of kernels.cpp.
#pragma once

#include "renderer/cloud/surfel_bytes.hpp"
#include "renderer/device/cpu/kernels/vectors.hpp"

namespace scancast::cpu {
namespace {

inline constexpr int blockSize = 256;
static_assert(blockSize % limitsStep == 0);
/// Loops run to a multiple of this: masked tails instead of scalar remainders.
inline constexpr int tailStep = 16;

/// Aligned as a whole: an alignment on an array's elements keeps the compiler from vectorising.
struct alignas(64) Block {
    std::uint32_t words[4][blockSize];
    float across[blockSize], down[blockSize];  ///< px from the view axis
    float x[blockSize], y[blockSize];          ///< px in the whole picture, once placeBlock() has been asked
    float depth[blockSize];
    float ratio[blockSize];            ///< of the sample's radius to the run's plain one
    float half[blockSize];             ///< half the splat's size, px
    std::int32_t drawable[blockSize];  ///< 0 or -1
    std::uint32_t color[blockSize];    ///< or, where keys carry them, ordinals
    int count = 0;                     ///< samples
    int padded = 0;  ///< count up to a multiple of tailStep; the samples beyond are not drawable
    /// Which sample stands where: numberIn(). Neighbours of a run lie beside each other in the picture, too, and a processor waits
    /// where it reads what a store before has written in part; spread out, a vector's samples are far from each other.
    bool spread = false;
};

/// How far a vector's samples lie from each other in a spread block.
inline constexpr int spreadStep = blockSize / 8;

/// The number in the block, counted in the run's order, of what stands at a place of its arrays.
inline int numberIn(const Block& b, int at) {
    return b.spread ? ((at & 3) * 2 + ((at >> 2) & 1)) * spreadStep + (at >> 3) : at;
}

/// Four samples at a time: rows of words → columns.
inline void transposeSamples(const SplatRun& run, std::uint32_t first, Block& b) {
    const int whole = b.count & ~3;
    const SampleWords* const samples = run.samples + first;
    const int step = b.spread ? 2 * spreadStep : 1;
    const auto sample = [samples](int i) { return load<Ints4>(samples + i); };
    for (int i = 0; i < whole; i += 4) {
        // A line of the cache at a time, of the block after this one.
        __builtin_prefetch(samples + blockSize + i);
        const int at = numberIn(b, i);
        const Ints4 s0 = sample(at), s1 = sample(at + step), s2 = sample(at + 2 * step),
                    s3 = sample(at + 3 * step);
        const Ints4 low01 = __builtin_shufflevector(s0, s1, 0, 4, 1, 5);
        const Ints4 low23 = __builtin_shufflevector(s2, s3, 0, 4, 1, 5);
        const Ints4 high01 = __builtin_shufflevector(s0, s1, 2, 6, 3, 7);
        const Ints4 high23 = __builtin_shufflevector(s2, s3, 2, 6, 3, 7);
        store<Ints4>(b.words[0] + i, __builtin_shufflevector(low01, low23, 0, 1, 4, 5));
        store<Ints4>(b.words[1] + i, __builtin_shufflevector(low01, low23, 2, 3, 6, 7));
        store<Ints4>(b.words[2] + i, __builtin_shufflevector(high01, high23, 0, 1, 4, 5));
        store<Ints4>(b.words[3] + i, __builtin_shufflevector(high01, high23, 2, 3, 6, 7));
    }
    for (int i = whole; i < b.padded; ++i) {
        const Ints4 s = i < b.count ? sample(i) : Ints4{0, 0, 0, 0};
        for (int w = 0; w < 4; ++w) b.words[w][i] = static_cast<std::uint32_t>(s[w]);
    }
}

/// A radius of 0 is none: then the run's.
inline void setRatios(const SplatPass& pass, const SplatRun& run, Block& b) {
    if (pass.radii == nullptr) {
        for (int i = 0; i < b.padded; ++i) b.ratio[i] = 1.0f;
        return;
    }
    for (int i = 0; i < b.padded; ++i) b.ratio[i] = pass.radii[(b.words[3][i] >> 16) & 255];
    for (int i = 0; i < b.padded; i += wideLanes) {
        const FloatW radius = load<FloatW>(b.ratio + i);
        store(b.ratio + i, radius > 0.0f ? radius * run.ratioUnit : all(1.0f));
    }
}

/// Samples' places: px from the view axis, right and down (times depth in perspective), and depths.
struct Centres {
    FloatW across, down, depth;
};

/// Of samples' first two words.
inline Centres centresOf(const SplatRun& run, IntW xy, IntW zi) {
    const auto& m = run.toPicture;
    const FloatW sx = toFloat(xy & 0xffff), sy = toFloat((xy >> 16) & 0xffff), sz = toFloat(zi & 0xffff);
    return {m[0][0] * sx + (m[0][1] * sy + (m[0][2] * sz + m[0][3])),
            m[1][0] * sx + (m[1][1] * sy + (m[1][2] * sz + m[1][3])),
            m[2][0] * sx + (m[2][1] * sy + (m[2][2] * sz + m[2][3]))};
}

/// Px. `inverse`: 1 / depth, or 1 without perspective.
inline FloatW sizeOfSprites(const SplatPass& pass, const SplatRun& run, FloatW ratio, FloatW inverse) {
    const FloatW wanted = (run.sizeFactor * ratio) * inverse;
    return smaller(larger(wanted, all(pass.minPx)), all(pass.maxPx));
}

/// Depths, and places and sizes as seen from the view axis. What is not drawable keeps finite depths, so that nothing later
/// needs care.
template <bool perspective, bool sized>
void project(const SplatPass& pass, const SplatRun& run, Block& b) {
    const IntW count = all(b.count);
    IntW number = toInt(laneNumbers<wideLanes>());
    for (int i = 0; i < b.padded; i += wideLanes, number += wideLanes) {
        const Centres c = centresOf(run, load<IntW>(b.words[0] + i), load<IntW>(b.words[1] + i));
        const IntW seen = (c.depth >= pass.near) & (c.depth <= pass.far) & (number < count);
        const FloatW d = seen ? c.depth : all(1.0f);
        const FloatW inverse = perspective ? 1.0f / d : all(1.0f);
        store(b.across + i, c.across * inverse);
        store(b.down + i, c.down * inverse);
        store(b.depth + i, d);
        if constexpr (sized)
            store(b.half + i, 0.5f * sizeOfSprites(pass, run, load<FloatW>(b.ratio + i), inverse));
        store(b.drawable + i, seen);
    }
}

/// Where the samples lie in a picture whose view axis lies there.
inline void placeBlock(float centerX, float centerY, Block& b) {
    // Far outside any picture, and still exact as an integer.
    const FloatW outside = all(1048576.0f);
    for (int i = 0; i < b.padded; i += wideLanes) {
        const FloatW x = centerX + load<FloatW>(b.across + i), y = centerY + load<FloatW>(b.down + i);
        store(b.x + i, smaller(larger(x, -outside), outside));
        store(b.y + i, smaller(larger(y, -outside), outside));
    }
}

inline void filterByClass(const SplatPass& pass, Block& b) {
    for (int i = 0; i < b.padded; ++i) {
        b.drawable[i] &= -static_cast<std::int32_t>(pass.classes[b.words[2][i] >> 24]);
    }
}

inline void filterOutliers(Block& b) {
    for (int i = 0; i < b.padded; ++i)
        b.drawable[i] &= ((b.words[3][i] >> 16) & 255) == outlierRadius ? 0 : -1;
}

inline void filterByClip(const SplatRun& run, Block& b) {
    for (int i = 0; i < b.padded; ++i) {
        const std::int32_t x = static_cast<std::int32_t>(b.words[0][i] & 0xffff);
        const std::int32_t y = static_cast<std::int32_t>(b.words[0][i] >> 16);
        const std::int32_t z = static_cast<std::int32_t>(b.words[1][i] & 0xffff);
        const bool inside = (x >= run.clipMin[0]) & (x <= run.clipMax[0]) & (y >= run.clipMin[1]) &
                            (y <= run.clipMax[1]) & (z >= run.clipMin[2]) & (z <= run.clipMax[2]);
        b.drawable[i] &= inside ? -1 : 0;
    }
}

inline IntW insideRegion(const RunRegion& region, FloatW x, FloatW y, FloatW z) {
    IntW inside = all(-1);
    for (std::int32_t p = 0; p < region.count; ++p) {
        const auto& plane = region.planes[p];
        inside &= plane[0] * x + (plane[1] * y + (plane[2] * z + plane[3])) >= 0.0f;
    }
    return inside;
}

inline void filterByRegions(const SplatRun& run, Block& b) {
    const RunRegion* const kept = run.regions + run.droppedCount;
    for (int i = 0; i < b.padded; i += wideLanes) {
        const IntW xy = load<IntW>(b.words[0] + i), zi = load<IntW>(b.words[1] + i);
        const FloatW x = toFloat(xy & 0xffff), y = toFloat((xy >> 16) & 0xffff), z = toFloat(zi & 0xffff);
        IntW drawable = load<IntW>(b.drawable + i);
        for (std::int32_t r = 0; r < run.droppedCount; ++r)
            drawable &= ~insideRegion(run.regions[r], x, y, z);
        if (run.keptCount > 0) {
            IntW any = all(0);
            for (std::int32_t r = 0; r < run.keptCount; ++r) any |= insideRegion(kept[r], x, y, z);
            drawable &= any;
        }
        store(b.drawable + i, drawable);
    }
}

/// Fading levels: the samples whose turn has come.
inline void filterByTurn(const SplatRun& run, std::uint32_t first, Block& b) {
    const std::uint32_t base = (run.firstOrdinal + first) * run.turnStep + run.turnBase;
    for (int i = 0; i < b.padded; ++i) {
        const std::uint32_t turn = base + static_cast<std::uint32_t>(numberIn(b, i)) * run.turnStep;
        b.drawable[i] &= turn <= run.lastTurn ? -1 : 0;
    }
}

/// The nearest of 256 entries.
inline std::uint32_t tableEntry(const std::uint32_t* table, float index) {
    index = index < 0.0f ? 0.0f : index;
    index = index > 255.0f ? 255.0f : index;
    return table[static_cast<std::int32_t>(index + 0.5f)];
}

/// Each channel by itself.
inline std::uint32_t toned(const std::uint32_t* ramp, std::uint32_t rgb) {
    return (ramp[rgb & 255] & 0xff) | (ramp[(rgb >> 8) & 255] & 0xff00) |
           (ramp[(rgb >> 16) & 255] & 0xff0000);
}

/// Near infrared, red and green in the places of red, green and blue; `word`: the sample's third.
inline std::uint32_t infraredRgb(std::uint32_t word, std::uint32_t beside) {
    return beside >> 24 | (word & 0xffff) << 8;
}

/// What stands beside a sample of the run; 0 where nothing does.
inline std::uint32_t besideAt(const SplatRun& run, std::uint32_t sample) {
    return run.beside != nullptr ? run.beside[sample] : 0;
}

/// The colour times the factor of the sample's intensity; `word`: the sample's second.
inline std::uint32_t brightened(const SplatPass& pass, std::uint32_t color, std::uint32_t word) {
    const float intensity = static_cast<float>(static_cast<std::int32_t>(word >> 16));
    const std::uint32_t factor =
        tableEntry(pass.factors, (intensity - pass.intensityLow) * pass.intensityScale);
    std::uint32_t out = 0;
    for (int shift = 0; shift < 24; shift += 8) {
        const std::uint32_t channel = (((color >> shift) & 255) * factor + 128) >> 8;
        out |= (channel < 255 ? channel : 255) << shift;
    }
    return out;
}

/// Of twice the mean curvature.
inline float curvatureIndex(const SplatPass& pass, const SplatRun& run, std::uint32_t code) {
    const float sum = pass.curvatures[code & 255] + pass.curvatures[(code >> 8) & 255];
    return sum * run.indexStep + run.indexBase;
}

/// The block's first sample is the run's `first`.
inline void colorize(const SplatPass& pass, const SplatRun& run, std::uint32_t first, Block& b) {
    const auto* const words = b.words;
    const auto beside = [&](int i) {
        return besideAt(run, first + static_cast<std::uint32_t>(numberIn(b, i)));
    };
    switch (pass.coloring) {
        case Coloring::Rgb:
            for (int i = 0; i < b.padded; ++i) b.color[i] = words[2][i] & 0xffffff;
            return;
        case Coloring::PerRun:
            for (int i = 0; i < b.padded; ++i) b.color[i] = run.color;
            return;
        case Coloring::Intensity:
            for (int i = 0; i < b.padded; ++i) {
                const float value = static_cast<float>(static_cast<std::int32_t>(words[1][i] >> 16));
                b.color[i] = tableEntry(pass.ramp, (value - pass.colorLow) * pass.colorScale);
            }
            return;
        case Coloring::Elevation:
            for (int i = 0; i < b.padded; ++i) {
                const float z = static_cast<float>(static_cast<std::int32_t>(words[1][i] & 0xffff));
                b.color[i] = tableEntry(pass.ramp, z * run.indexStep + run.indexBase);
            }
            return;
        case Coloring::Classification:
            for (int i = 0; i < b.padded; ++i) b.color[i] = pass.ramp[words[2][i] >> 24];
            return;
        case Coloring::Normal:
            for (int i = 0; i < b.padded; ++i) b.color[i] = pass.normals[words[3][i] & 0xffff];
            return;
        case Coloring::Depth:
            for (int i = 0; i < b.padded; ++i) {
                b.color[i] = tableEntry(pass.ramp, (b.depth[i] - pass.colorLow) * pass.colorScale);
            }
            return;
        case Coloring::Toned:
            for (int i = 0; i < b.padded; ++i) b.color[i] = toned(pass.ramp, words[2][i]);
            return;
        case Coloring::Curvature:
            for (int i = 0; i < b.count; ++i)
                b.color[i] = tableEntry(pass.ramp, curvatureIndex(pass, run, beside(i)));
            return;
        case Coloring::Infrared:
            for (int i = 0; i < b.count; ++i)
                b.color[i] = toned(pass.ramp, infraredRgb(words[2][i], beside(i)));
            return;
    }
}

inline void brighten(const SplatPass& pass, Block& b) {
    for (int i = 0; i < b.padded; ++i) b.color[i] = brightened(pass, b.color[i], b.words[1][i]);
}

/// Everything but places in the picture. `sized`: ratios and sizes, too, of samples that are spread if the block is full.
template <bool sized>
void loadBlock(const SplatPass& pass, const SplatRun& run, std::uint32_t first, Block& b) {
    const std::uint32_t left = run.count - first;
    b.count = left < blockSize ? static_cast<int>(left) : blockSize;
    b.padded = (b.count + tailStep - 1) & ~(tailStep - 1);
    b.spread = sized && b.count == blockSize;
    transposeSamples(run, first, b);
    if (sized) setRatios(pass, run, b);
    if (pass.perspective) {
        project<true, sized>(pass, run, b);
    } else {
        project<false, sized>(pass, run, b);
    }
    if (pass.classes != nullptr) filterByClass(pass, b);
    if (!pass.outliers) filterOutliers(b);
    if (run.clipped) filterByClip(run, b);
    if (run.regions != nullptr) filterByRegions(run, b);
    if (run.lastTurn != 0xffffffffu) filterByTurn(run, first, b);
    if (pass.payload == SplatPayload::Sample) {
        for (int i = 0; i < b.padded; ++i)
            b.color[i] = run.firstOrdinal + first + static_cast<std::uint32_t>(numberIn(b, i));
    } else if (pass.payload == SplatPayload::Color) {
        colorize(pass, run, first, b);
        if (pass.byIntensity) brighten(pass, b);
    }
}

}  // namespace
}  // namespace scancast::cpu
