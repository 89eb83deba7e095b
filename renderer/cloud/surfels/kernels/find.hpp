// Finding the nearest neighbours: for a group of queries that stand together by sharing their candidates, and
// for a single one from the root of the boxes. Included by surfel_kernels.cpp only.
#pragma once

#include <immintrin.h>

#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"

namespace scancast::surfel {
namespace {

constexpr float infinity = __builtin_inff();

struct Box {
    float low[3], high[3];
};

/// Squared distances from a box to the eight of a block. Subtraction, square and sum round monotonically, so
/// none is larger than the squared distance, as computed, between points inside.
inline void distancesTo(const BoxBlock& block, const Box& box, float (&squared)[blockBoxes]) {
    for (int i = 0; i < blockBoxes; ++i) {
        float sum = 0;
        for (int a = 0; a < 3; ++a) {
            const float below = block.low[a][i] - box.high[a], above = box.low[a] - block.high[a][i];
            float d = below > above ? below : above;
            d = d > 0 ? d : 0;
            sum += d * d;
        }
        squared[i] = sum;
    }
}

struct Entry {
    std::uint32_t block;
    int level;
};

/// Calls visit(leaf) for each leaf within a squared distance of a box, until it returns false.
template <class Visit>
inline void leavesWithin(const IndexView& index, const Box& box, float limit, Visit&& visit) {
    Entry stack[maxLevels * blockBoxes];
    int top = 0;
    stack[top++] = {0, index.levels - 1};
    while (top > 0) {
        const Entry e = stack[--top];
        float squared[blockBoxes];
        distancesTo(index.blocks[index.levelBegin[e.level] + e.block], box, squared);
        unsigned hits = 0;
        for (int i = 0; i < blockBoxes; ++i) hits |= unsigned(squared[i] <= limit) << i;
        if (e.level > 0) {
            for (; hits != 0; hits &= hits - 1)
                stack[top++] = {e.block * blockBoxes + unsigned(__builtin_ctz(hits)), e.level - 1};
        } else {
            for (; hits != 0; hits &= hits - 1)
                if (!visit(e.block * blockBoxes + unsigned(__builtin_ctz(hits)))) return;
        }
    }
}

/// Copies the points of all leaves near a box; -1 where there are too many. Padded with points at infinity.
inline int gather(const IndexView& index, const Box& box, float limit, SearchScratch& w) {
    int n = 0;
    bool fits = true;
    leavesWithin(index, box, limit, [&](std::uint32_t leaf) {
        const std::uint32_t begin = index.leafBegin[leaf], end = index.leafBegin[leaf + 1];
        fits = n + int(end - begin) <= capacity;
        if (!fits) return false;
        for (std::uint32_t i = begin; i < end; ++i, ++n) {
            w.x[n] = index.x[i];
            w.y[n] = index.y[i];
            w.z[n] = index.z[i];
            w.number[n] = i;
        }
        return true;
    });
    if (!fits) return -1;
    for (int i = 0; i < 16; ++i) w.x[n + i] = w.y[n + i] = w.z[n + i] = infinity;
    return n;
}

inline bool positionLess(float ax, float ay, float az, float bx, float by, float bz) {
    if (ax != bx) return ax < bx;
    if (ay != by) return ay < by;
    return az < bz;
}

/// Equal distances go by position: so the order does not depend on the order of the points. Quick where only
/// those are out of order.
inline void sortPicks(SearchScratch& w, int n) {
    for (int i = 1; i < n; ++i) {
        const int p = w.pick[i];
        int j = i;
        for (; j > 0; --j) {
            const int q = w.pick[j - 1];
            if (w.squared[q] < w.squared[p] || (w.squared[q] == w.squared[p] &&
                                                positionLess(w.x[q], w.y[q], w.z[q], w.x[p], w.y[p], w.z[p])))
                break;
            w.pick[j] = q;
        }
        w.pick[j] = p;
    }
}

/// Squared distances of the n gathered points from a place.
inline void measure(SearchScratch& w, int n, const float (&at)[3]) {
    for (int i = 0; i < ((n + 15) & ~15); ++i) {
        const float dx = w.x[i] - at[0], dy = w.y[i] - at[1], dz = w.z[i] - at[2];
        w.squared[i] = dx * dx + dy * dy + dz * dz;
    }
}

/// Which of n measured points lie within `limit`: their distances into w.near, their numbers into w.found.
inline int keepWithin(SearchScratch& w, int n, float limit) {
    int m = 0;
#if SCANCAST_SIMD_LEVEL == 4
    const __m512 most = _mm512_set1_ps(limit);
    __m512i number = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    for (int i = 0; i < n; i += 16) {
        const __m512 squared = _mm512_loadu_ps(w.squared + i);
        const __mmask16 keep = _mm512_cmp_ps_mask(squared, most, _CMP_LE_OQ);
        _mm512_storeu_ps(w.near + m, _mm512_maskz_compress_ps(keep, squared));
        _mm512_storeu_si512(w.found + m, _mm512_maskz_compress_epi32(keep, number));
        m += __builtin_popcount(keep);
        number = _mm512_add_epi32(number, _mm512_set1_epi32(16));
    }
#elif SCANCAST_SIMD_LEVEL == 3
    const __m256 most = _mm256_set1_ps(limit);
    __m256i number = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    for (int i = 0; i < n; i += 8) {
        const __m256 squared = _mm256_loadu_ps(w.squared + i);
        const unsigned keep = unsigned(_mm256_movemask_ps(_mm256_cmp_ps(squared, most, _CMP_LE_OQ)));
        const std::uint64_t bytes = _pdep_u64(keep, 0x0101010101010101u) * 255;
        const __m256i lanes =
            _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(std::int64_t(_pext_u64(0x0706050403020100u, bytes))));
        _mm256_storeu_ps(w.near + m, _mm256_permutevar8x32_ps(squared, lanes));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(w.found + m),
                            _mm256_permutevar8x32_epi32(number, lanes));
        m += __builtin_popcount(keep);
        number = _mm256_add_epi32(number, _mm256_set1_epi32(8));
    }
#else
    const __m128 most = _mm_set1_ps(limit);
    for (int i = 0; i < n; i += 4) {
        unsigned keep = unsigned(_mm_movemask_ps(_mm_cmple_ps(_mm_loadu_ps(w.squared + i), most)));
        for (; keep != 0; keep &= keep - 1, ++m) {
            w.found[m] = i + __builtin_ctz(keep);
            w.near[m] = w.squared[w.found[m]];
        }
    }
#endif
    return m;
}

/// Of m points in w.near and w.found: where some are equally far they share a rank; they take the places from there on,
/// and are put in order afterwards.
inline void placeEquals(SearchScratch& w, int m) {
    for (int i = 0; i < m; ++i) w.pick[i] = -1;
    for (int i = 0; i < m; ++i) {
        int place = 0;
        for (int j = 0; j < m; ++j) place += w.near[j] < w.near[i];
        while (w.pick[place] >= 0) ++place;
        w.pick[place] = w.found[i];
    }
    sortPicks(w, m);
}

/// Of n measured points those within `limit`, in order, into w.pick; how many.
inline int rankWithin(SearchScratch& w, int n, float limit) {
    const int m = keepWithin(w, n, limit);
    for (int i = 0; i < 16; ++i) w.near[m + i] = infinity;
    // A point's rank is how many are nearer. Together they are 0 + 1 + … + (m - 1), or less where some share one.
    int ranks = 0;
    for (int block = 0; block < m; block += 16) {
        int rank[16] = {};
        for (int j = 0; j < m; ++j)
            for (int l = 0; l < 16; ++l) rank[l] += w.near[j] < w.near[block + l];
        const int end = m - block < 16 ? m - block : 16;
        for (int l = 0; l < end; ++l) {
            w.pick[rank[l]] = w.found[block + l];
            ranks += rank[l];
        }
    }
    if (2 * ranks != m * (m - 1)) placeEquals(w, m);
    return m;
}

/// Keeps the nearest `wanted` in order in w.best.
inline void offer(const IndexView& index, std::uint32_t p, float squared, int wanted, int& found,
                  SearchScratch& w) {
    const auto less = [&](int j) {
        const std::uint32_t q = w.best[j];
        return squared < w.bestSquared[j] ||
               (squared == w.bestSquared[j] &&
                positionLess(index.x[p], index.y[p], index.z[p], index.x[q], index.y[q], index.z[q]));
    };
    if (found == wanted && !less(found - 1)) return;
    int j = found < wanted ? found++ : found - 1;
    for (; j > 0 && less(j - 1); --j) {
        w.best[j] = w.best[j - 1];
        w.bestSquared[j] = w.bestSquared[j - 1];
    }
    w.best[j] = p;
    w.bestSquared[j] = squared;
}

struct Descent {
    std::uint32_t block;
    int level;
    float squared;
};

/// The nearest `wanted` points to a place, the point there included, from the root: exact whatever the
/// distribution.
inline int searchFromRoot(const IndexView& index, const float (&at)[3], int wanted, SearchScratch& w) {
    const Box box{{at[0], at[1], at[2]}, {at[0], at[1], at[2]}};
    Descent stack[maxLevels * blockBoxes];
    int top = 0, found = 0;
    stack[top++] = {0, index.levels - 1, 0};
    while (top > 0) {
        const Descent d = stack[--top];
        if (found == wanted && d.squared > w.bestSquared[found - 1]) continue;
        if (d.level < 0) {
            for (std::uint32_t i = index.leafBegin[d.block]; i < index.leafBegin[d.block + 1]; ++i) {
                const float dx = index.x[i] - at[0], dy = index.y[i] - at[1], dz = index.z[i] - at[2];
                offer(index, i, dx * dx + dy * dy + dz * dz, wanted, found, w);
            }
            continue;
        }
        float squared[blockBoxes];
        distancesTo(index.blocks[index.levelBegin[d.level] + d.block], box, squared);
        const int first = top;
        for (int i = 0; i < blockBoxes; ++i) {
            if (!(squared[i] < infinity) || (found == wanted && squared[i] > w.bestSquared[found - 1]))
                continue;
            int j = top++;
            for (; j > first && stack[j - 1].squared < squared[i]; --j) stack[j] = stack[j - 1];
            stack[j] = {d.block * blockBoxes + unsigned(i), d.level - 1, squared[i]};
        }
    }
    return found;
}

}  // namespace
}  // namespace scancast::surfel
