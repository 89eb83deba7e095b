// Normals of the filled depth: one field per level, and per pixel the level that its distance calls for.
// docs/spec/pyramid.md §6. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/formulas.hpp"
#include "renderer/device/cpu/kernels/normal_plane.hpp"
#include "renderer/device/cpu/kernels/texels.hpp"

namespace scancast::cpu {
namespace {

/// Points of a row of texels in view space, z towards the viewer.
struct ViewPoint {
    FloatW x, y, z;
};

inline ViewPoint viewPointOf(const LevelNormals& n, FloatW texelX, FloatW texelY, FloatW depth) {
    const Unprojection& u = n.unprojection;
    const FloatW scale = u.perspective ? depth : all(1.0f);
    return {((texelX + 0.5f) * n.texel - u.centerX) * u.step * scale,
            (u.centerY - (texelY + 0.5f) * n.texel) * u.step * scale, -depth};
}

inline ViewPoint difference(const ViewPoint& a, const ViewPoint& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// Where one side's depth is this many texels further off than steepness times the other's, an outline lies
/// between: it is not part of the slope.
inline constexpr float outlineTexels = 2, outlineSteepness = 4;

/// How much of the way to two neighbours is the slope that `depth` is on: 1, less where an outline begins, 0
/// beyond it. Continuous, so that what is nearly the same looks nearly the same.
struct Sides {
    FloatW first, second;
};

inline Sides sameSurface(FloatW depth, FloatW texel, FloatW first, FloatW second) {
    const auto rise = [&](FloatW d) { return smaller(absolute(d - depth), all(1e30f)); };
    const FloatW a = rise(first), b = rise(second), least = outlineTexels * texel;
    const auto share = [&](FloatW own, FloatW other, FloatW d) {
        const FloatW s = 2.0f - own / (least + outlineSteepness * other);
        return d < finiteDepths ? smaller(larger(s, all(0.0f)), all(1.0f)) : all(0.0f);
    };
    return {share(a, b, first), share(b, a, second)};
}

/// Central differences; towards a side without depth, outside, or across an outline, one-sided ones: else
/// outlines would be lit like grazing slopes, which is black.
void levelNormals(const LevelNormals& n, int y0, int y1) {
    const int lastX = n.out.width - 1, lastY = n.out.height - 1;
    for (int y = y0; y < y1; ++y) {
        const int above = y > 0 ? y - 1 : 0, below = y < lastY ? y + 1 : lastY;
        const float* const row = n.depth + rowOf(n.depthStride, y);
        const float* const rowAbove = n.depth + rowOf(n.depthStride, above);
        const float* const rowBelow = n.depth + rowOf(n.depthStride, below);
        const std::int64_t out = rowOf(n.out.stride, y);
        for (int x = 0; x < n.out.width; x += wideLanes) {
            const IntW xi = laneIndices() + x;
            const FloatW tx = toFloat(xi), ty = all(static_cast<float>(y));
            const FloatW left = toFloat(xi > 0 ? xi - 1 : all(0));
            const FloatW right = toFloat(xi < lastX ? xi + 1 : all(lastX));
            const FloatW depth = load<FloatW>(row + x);
            const ViewPoint own = viewPointOf(n, tx, ty, depth);
            const FloatW texel =
                (n.texel * n.unprojection.step) * (n.unprojection.perspective ? depth : all(1.0f));
            const auto beside = [&](FloatW px, FloatW py, FloatW d, FloatW share) {
                const ViewPoint p = viewPointOf(n, px, py, d < finiteDepths ? d : depth);
                return ViewPoint{own.x + (p.x - own.x) * share, own.y + (p.y - own.y) * share,
                                 own.z + (p.z - own.z) * share};
            };
            // Beyond the border nothing is known.
            const FloatW none = all(__builtin_inff());
            const FloatW rightDepth = xi < lastX ? load<FloatW>(row + x + 1) : none;
            const FloatW leftDepth = xi > 0 ? load<FloatW>(row + x - 1) : none;
            const FloatW upper = above < y ? load<FloatW>(rowAbove + x) : none;
            const FloatW lower = below > y ? load<FloatW>(rowBelow + x) : none;
            const Sides across = sameSurface(depth, texel, rightDepth, leftDepth);
            const Sides along = sameSurface(depth, texel, upper, lower);
            const ViewPoint a = difference(beside(right, ty, rightDepth, across.first),
                                           beside(left, ty, leftDepth, across.second));
            const ViewPoint b = difference(beside(tx, all(static_cast<float>(above)), upper, along.first),
                                           beside(tx, all(static_cast<float>(below)), lower, along.second));
            const FloatW nx = a.y * b.z - a.z * b.y, ny = a.z * b.x - a.x * b.z, nz = a.x * b.y - a.y * b.x;
            const FloatW square = nx * nx + ny * ny + nz * nz;
            const IntW known = (square > 1e-37f) & (square < finiteDepths);
            const FloatW scale = 1.0f / squareRoot<wideLanes>(known ? square : all(1.0f));
            // Nothing to compare with: facing the viewer.
            storeInside(n.out.x + out, x, n.out.width, known ? nx * scale : all(0.0f));
            storeInside(n.out.y + out, x, n.out.width, known ? ny * scale : all(0.0f));
            storeInside(n.out.z + out, x, n.out.width, known ? nz * scale : all(1.0f));
        }
        float* const planes[] = {n.out.x, n.out.y, n.out.z};
        for (float* const plane : planes) {
            plane[out - 1] = plane[out];
            plane[out + lastX + 1] = plane[out + lastX];
        }
    }
}

struct Vector3 {
    FloatW x, y, z;
};

/// Adds weight · the level's bilinear value, at a row of pixels.
struct LevelValue {
    const NormalLevel& normals;
    int x, y, level;
    FloatW weight;
    Vector3& sum;

    template <int spreadLevel>
    void run() const {
        const int left = texelBefore(x, level), top = texelBefore(y, level);
        const float texels = 1.0f / static_cast<float>(1 << level);
        const FloatW placeX = (toFloat(laneIndices() + x) + 0.5f) * texels - 0.5f;
        const float placeY = (static_cast<float>(y) + 0.5f) * texels - 0.5f;
        addRows(left, top, placeX - floorOf(placeX), placeY - static_cast<float>(top),
                [](const float* p) { return spread<spreadLevel>(p); });
    }

    template <class Spread>
    void addRows(int left, int top, FloatW fx, float fy, const Spread& at) const {
        const int last = normals.height - 1;
        const std::int64_t upper = rowOf(normals.stride, top < 0 ? 0 : top) + left;
        const std::int64_t lower = rowOf(normals.stride, top + 1 > last ? last : top + 1) + left;
        const auto add = [&](const float* plane, FloatW& to) {
            const FloatW a = at(plane + upper), b = at(plane + upper + 1);
            const FloatW c = at(plane + lower), d = at(plane + lower + 1);
            const FloatW above = a + (b - a) * fx, below = c + (d - c) * fx;
            to += weight * (above + (below - above) * fy);
        };
        add(normals.x, sum.x);
        add(normals.y, sum.y);
        add(normals.z, sum.z);
    }
};

inline void addLevel(const PixelNormals& p, int x, int y, int level, FloatW weight, Vector3& sum) {
    const NormalLevel& normals = p.levels[level];
    if (level == 0) {
        const std::int64_t place = rowOf(normals.stride, y) + x;
        sum.x += weight * load<FloatW>(normals.x + place);
        sum.y += weight * load<FloatW>(normals.y + place);
        sum.z += weight * load<FloatW>(normals.z + place);
        return;
    }
    withSpread(level, LevelValue{normals, x, y, level, weight, sum});
}

/// Least and greatest of the lanes that count.
inline void rangeOf(FloatW v, int lanes, float& least, float& greatest) {
    for (int i = 0; i < wideLanes; ++i) {
        if ((lanes >> i & 1) == 0) continue;
        least = v[i] < least ? v[i] : least;
        greatest = v[i] > greatest ? v[i] : greatest;
    }
}

void pixelNormals(const PixelNormals& p, int y0, int y1) {
    const FloatW last = all(static_cast<float>(p.count - 1));
    for (int y = y0; y < y1; ++y) {
        const float* const depths = p.depth + rowOf(p.depthStride, y);
        std::uint32_t* const out = p.out + rowOf(p.outStride, y);
        for (int x = 0; x < p.width; x += wideLanes) {
            const int lanes = p.width - x < wideLanes ? p.width - x : wideLanes;
            const FloatW depth = loadSome<FloatW>(depths + x, lanes);
            const IntW shown = (depth < finiteDepths) & (laneIndices() < lanes);
            const int bits = bitsOf(shown);
            if (bits == 0) {
                storeSome(out + x, IntW{}, lanes);
                continue;
            }
            const FloatW size = p.size / (p.perspective ? depth : all(1.0f));
            const FloatW wished = log2Of(larger(size, all(p.smallest)));
            const FloatW level = smaller(larger(wished, all(0.0f)), last);
            float least = infinity, greatest = 0;
            rangeOf(level, bits, least, greatest);
            Vector3 sum{};
            for (int k = static_cast<int>(least); k < p.count && static_cast<float>(k) < greatest + 1.0f;
                 ++k) {
                const FloatW distance = level - static_cast<float>(k);
                const FloatW weight = larger(1.0f - absolute(distance), all(0.0f));
                addLevel(p, x, y, k, weight, sum);
            }
            storeSome(out + x, shown ? packNormal(sum.x, sum.y, sum.z) : all(0), lanes);
        }
    }
}

}  // namespace
}  // namespace scancast::cpu
