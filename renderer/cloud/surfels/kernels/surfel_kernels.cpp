// Compiled once per SIMD level, with SCANCAST_SIMD_LEVEL = 2, 3 or 4 and the matching -march.
#include "renderer/cloud/surfels/kernels/surfel_kernels.hpp"

#include "renderer/cloud/surfels/kernels/find.hpp"
#include "renderer/cloud/surfels/kernels/principal.hpp"

#if SCANCAST_SIMD_LEVEL == 4
#define SCANCAST_SIMD_NAMESPACE v4
#elif SCANCAST_SIMD_LEVEL == 3
#define SCANCAST_SIMD_NAMESPACE v3
#else
#define SCANCAST_SIMD_NAMESPACE v2
#endif

namespace scancast::surfel {
namespace {

constexpr double lineRatio = 1.0 / 16;    ///< λ2/λ1 below which more neighbours are asked for
constexpr double straight = 1e-9;         ///< λ2/λ1 below which there is no surface
constexpr float besideLine = 1.0f / 16;   ///< of the squared reach: who is farther from the line is beside it
constexpr double roundingUnit = 0x1p-24;  ///< of a float coordinate, relative

// Squared distances, from the last point to the next, and from the last group to the next.
constexpr float likelyGrowth = 1.3f, groupGrowth = 1.8f;

struct Run {
    const IndexView& index;
    int k;
    SearchScratch& w;
    void (*emit)(void*, const Solved&);
    void* context;

    int neighboursAt(int level) const {
        const int wanted = k << level;
        return wanted < int(index.points) - 1 ? wanted : int(index.points) - 1;
    }
    bool canDouble(int level) const {
        return level + 1 < doublings && (k << (level + 1)) <= maxNeighbours &&
               (k << level) < int(index.points) - 1;
    }
};

float largest(const float (&p)[3]) {
    float m = 0;
    for (const float c : p) {
        const float size = c < 0 ? -c : c;
        m = size > m ? size : m;
    }
    return m;
}

void solveGroup(const Run& run, int level, const std::uint32_t* points, int count);

/// Averages of one chunk of lanes.
struct Distances {
    Lanes all, nearest;
};

void emitLane(const Run& run, int level, int lane, int l, int m, const Matrices& a, const Directions& d,
              const Distances& distances, bool straightLine) {
    const Neighbourhoods& n = run.w.waiting[level];
    Solved s;
    s.point = n.point[lane];
    s.neighbours = m;
    s.reach2 = n.reach2[lane];
    for (int i = 0; i < 3; ++i) {
        s.axis[i] = d.axis[0][i][l];
        s.middle[i] = float(a.mean[i][l]);
        s.normal[i] = straightLine ? 0 : d.axis[2][i][l];
    }
    const double longest = a.diagonal[0][l], across = a.diagonal[1][l], thick = a.diagonal[2][l];
    s.ratio = longest > 0 && across > 0 ? across / longest : 0;
    s.flat = across > 0 ? (thick > 0 ? thick / across : 0) : 1;
    s.radius = float(distances.all[l]);
    s.nearby = float(distances.nearest[l]);
    s.extended = level > 0;
    s.line = straightLine || across < lineRatio * longest;
    s.witnesses = n.witnesses[lane];
    for (int i = 0; i < s.witnesses; ++i) s.witness[i] = n.witness[i][lane];
    run.emit(run.context, s);
}

/// Solves all that wait at a level. Neighbourhoods that look like a line go on to the next level.
void flush(const Run& run, int level) {
    Neighbourhoods& n = run.w.waiting[level];
    const int m = run.neighboursAt(level), count = n.count;
    n.count = 0;
    std::uint32_t again[batchLanes];
    int agains = 0;
    for (int first = 0; first < count; first += chunk) {
        Matrices a;
        Directions d;
        covariance(n, first, m, a);
        principal(a, d);
        Distances distances;
        const int few = m < mostWitnesses ? m : mostWitnesses;
        averageDistances(n, first, m, few, distances.all.low, distances.nearest.low);
        averageDistances(n, first + partLanes, m, few, distances.all.high, distances.nearest.high);
        const Lanes(&variance)[3] = a.diagonal;
        for (int l = 0; l < chunk && first + l < count; ++l) {
            if (variance[1][l] < lineRatio * variance[0][l] && run.canDouble(level)) {
                again[agains++] = n.point[first + l];
                continue;
            }
            const double grain = roundingUnit * n.magnitude[first + l];
            const bool isLine =
                !(variance[1][l] > straight * variance[0][l]) || variance[1][l] <= 2 * grain * grain;
            emitLane(run, level, first + l, l, m, a, d, distances, isLine);
        }
    }
    std::uint32_t* retry = run.w.retry[level + 1 < doublings ? level + 1 : level];
    int& retries = run.w.retries[level + 1 < doublings ? level + 1 : level];
    for (int i = 0; i < agains; ++i) {
        retry[retries++] = again[i];
        if (retries < groupSize) continue;
        retries = 0;
        solveGroup(run, level + 1, retry, groupSize);
    }
}

/// Room for one more neighbourhood at a level.
int newLane(const Run& run, int level, std::uint32_t point, const float (&at)[3], float reach2) {
    Neighbourhoods& n = run.w.waiting[level];
    n.point[n.count] = point;
    n.magnitude[n.count] = largest(at);
    n.reach2[n.count] = reach2;
    return n.count++;
}

/// Who tells whether the point's surface is one: its nearest neighbours; where the k nearest lie on a line,
/// the nearest of those beside it. The neighbourhood's positions and w.ids are there.
void chooseWitnesses(const Run& run, int level, int lane, int m) {
    Neighbourhoods& n = run.w.waiting[level];
    int count = 0;
    if (level == 0) {
        for (; count < m && count < mostWitnesses; ++count) n.witness[count][lane] = run.w.ids[count];
    } else {
        const float u[3] = {n.x[run.k - 1][lane], n.y[run.k - 1][lane], n.z[run.k - 1][lane]};
        const float length2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        const float least = besideLine * n.reach2[lane];
        for (int j = 0; j < m && count < mostWitnesses; ++j) {
            const float x = n.x[j][lane], y = n.y[j][lane], z = n.z[j][lane];
            const float along = (x * u[0] + y * u[1] + z * u[2]) / length2;
            const float dx = x - along * u[0], dy = y - along * u[1], dz = z - along * u[2];
            if (dx * dx + dy * dy + dz * dz > least) n.witness[count++][lane] = run.w.ids[j];
        }
    }
    n.witnesses[lane] = count;
}

void addCandidates(const Run& run, int level, std::uint32_t point, const float (&at)[3], int m) {
    SearchScratch& w = run.w;
    Neighbourhoods& n = w.waiting[level];
    const int lane = newLane(run, level, point, at, w.squared[w.pick[m]]);
    for (int j = 0; j < m; ++j) {
        const int p = w.pick[j + 1];
        n.x[j][lane] = w.x[p] - at[0];
        n.y[j][lane] = w.y[p] - at[1];
        n.z[j][lane] = w.z[p] - at[2];
        w.ids[j] = w.number[p];
    }
    chooseWitnesses(run, level, lane, m);
}

void addSearched(const Run& run, int level, std::uint32_t point, const float (&at)[3], int m) {
    SearchScratch& w = run.w;
    searchFromRoot(run.index, at, m + 1, w);
    Neighbourhoods& n = w.waiting[level];
    const int lane = newLane(run, level, point, at, w.bestSquared[m]);
    for (int j = 0; j < m; ++j) {
        const std::uint32_t p = w.best[j + 1];
        n.x[j][lane] = run.index.x[p] - at[0];
        n.y[j][lane] = run.index.y[p] - at[1];
        n.z[j][lane] = run.index.z[p] - at[2];
        w.ids[j] = p;
    }
    chooseWitnesses(run, level, lane, m);
}

Box boxOf(const IndexView& index, const std::uint32_t* points, int count) {
    Box b{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (int i = 0; i < count; ++i) {
        const float p[3] = {index.x[points[i]], index.y[points[i]], index.z[points[i]]};
        for (int a = 0; a < 3; ++a) {
            b.low[a] = p[a] < b.low[a] ? p[a] : b.low[a];
            b.high[a] = p[a] > b.high[a] ? p[a] : b.high[a];
        }
    }
    return b;
}

/// The nearest `wanted` of the gathered points, first among those within a likely distance. False where there
/// are not that many within the limit, beyond which nothing was gathered.
bool findNearest(SearchScratch& w, int gathered, const float (&at)[3], int wanted, float likely,
                 float limit) {
    measure(w, gathered, at);
    return (likely < limit && rankWithin(w, gathered, likely) >= wanted) ||
           rankWithin(w, gathered, limit) >= wanted;
}

/// Neighbours of points that stand together: everything within the guessed distance of their box is gathered
/// once. Whoever's k-th neighbour is farther than that searches from the root.
void solveGroup(const Run& run, int level, const std::uint32_t* points, int count) {
    SearchScratch& w = run.w;
    const int m = run.neighboursAt(level);
    const float limit = w.guess[level];
    int gathered = -1;
    if (limit > 0) gathered = gather(run.index, boxOf(run.index, points, count), limit, w);
    float reach = 0, last = limit;
    for (int i = 0; i < count; ++i) {
        const std::uint32_t p = points[i];
        const float at[3] = {run.index.x[p], run.index.y[p], run.index.z[p]};
        if (gathered > m && findNearest(w, gathered, at, m + 1, last * likelyGrowth, limit))
            addCandidates(run, level, p, at, m);
        else
            addSearched(run, level, p, at, m);
        const Neighbourhoods& n = w.waiting[level];
        last = n.reach2[n.count - 1];
        reach = last > reach ? last : reach;
    }
    w.guess[level] = reach * groupGrowth;
    if (w.waiting[level].count >= batchLanes - groupSize) flush(run, level);
}

void solve(const IndexView& index, const std::uint32_t* groupBegin, std::uint32_t groups, int k,
           SearchScratch& w, void (*emit)(void*, const Solved&), void* context) {
    const Run run{index, k, w, emit, context};
    for (int level = 0; level < doublings; ++level) {
        w.guess[level] = 0;
        w.retries[level] = w.waiting[level].count = 0;
    }
    for (std::uint32_t g = 0; g < groups; ++g) {
        std::uint32_t points[groupSize];
        int count = 0;
        for (std::uint32_t p = groupBegin[g]; p < groupBegin[g + 1]; ++p) points[count++] = p;
        solveGroup(run, 0, points, count);
    }
    for (int level = 0; level < doublings; ++level) {
        const int count = w.retries[level];
        w.retries[level] = 0;
        if (count > 0) solveGroup(run, level, w.retry[level], count);
        flush(run, level);
    }
}

int nearest(const IndexView& index, std::uint32_t point, int k, SearchScratch& w) {
    const float at[3] = {index.x[point], index.y[point], index.z[point]};
    const int wanted = k + 1 < int(index.points) ? k + 1 : int(index.points);
    return searchFromRoot(index, at, wanted, w) - 1;
}

}  // namespace

namespace SCANCAST_SIMD_NAMESPACE {
const SurfelKernels kernels = {solve, nearest};
}

}  // namespace scancast::surfel
