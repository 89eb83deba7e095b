#include "renderer/cloud/surfels/layers.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <vector>

namespace scancast {

namespace {

/// Positions asked whether there are layers.
constexpr std::uint32_t asked = 4096;
/// Fewer layers are floors and roofs; of values that happen to be the same there are more.
constexpr std::size_t fewestLayers = 24, askedOfOne = 8;
/// Layers are farther apart than this many radii, at half of the positions.
constexpr float apart = 1.25f;
/// A cell is so many steps large at most, and more than half of it: its window sees ten, at first.
constexpr double stepsPerCell = 6.6;
/// Who is farther from the plane is on something else: values go one step up and down.
constexpr double mostSteps = 1.5;
constexpr int mostScales = 10;
/// Cells are tried so often, each time half as large.
constexpr int tries = 3;
/// λ3/λ2 and λ2/λ1 of a window that is a plane, and positions in it.
constexpr double thickest = 1.0 / 14, narrowest = 0.08, fewest = 16;
/// Planes of cells side by side are one within 26°, and so are normals of layers and of what they stand for.
constexpr double same = 0.9;
/// One in so many planes has to have other normals than its points.
constexpr std::size_t oneOf = 10;
/// Rounds in which planes grow, and how many steps away from one is still in it.
constexpr int growingRounds = 24;
constexpr float inPlane = 0.75f;

using Steps = std::vector<float>;  ///< of each position, the distance to the next layer

/// The values of one coordinate, each once.
std::vector<float> valuesOf(const NeighbourIndex& index, int axis, std::uint32_t stride) {
    std::vector<float> values;
    for (std::uint32_t p = 0; p < index.size(); p += stride) values.push_back(index.position(p)[axis]);
    tbb::parallel_sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

/// From one of the values to the nearer of the next ones.
float stepAt(const std::vector<float>& layers, float value) {
    const auto at = std::lower_bound(layers.begin(), layers.end(), value);
    float least = std::numeric_limits<float>::infinity();
    if (at != layers.begin()) least = *at - *(at - 1);
    if (at + 1 != layers.end()) least = std::min(least, *(at + 1) - *at);
    return least;
}

/// Empty where there are no layers.
Steps stepsAlong(const NeighbourIndex& index, const Evidence& evidence, int axis) {
    const std::uint32_t stride = std::max<std::uint32_t>(1, index.size() / asked);
    const std::size_t most = index.size() / stride / askedOfOne;
    const auto few = valuesOf(index, axis, stride);
    if (few.size() < fewestLayers || few.size() > most) return {};

    const auto areApart = [&](const std::vector<float>& layers) {
        std::size_t all = 0, far = 0;
        for (std::uint32_t p = 0; p < index.size(); p += stride, ++all)
            far += stepAt(layers, index.position(p)[axis]) > apart * evidence.radius(p);
        return 2 * far >= all;
    };
    // Of few values the next ones are not nearer than of all.
    if (!areApart(few)) return {};
    const auto layers = valuesOf(index, axis, 1);
    if (!areApart(layers)) return {};
    Steps steps(index.size());
    for (std::uint32_t p = 0; p < index.size(); ++p) steps[p] = stepAt(layers, index.position(p)[axis]);
    return steps;
}

/// The plane that a position is in.
struct Facing {
    glm::vec3 normal{0};  ///< 0: none
    float offset = 0;     ///< normal · any place in it
    explicit operator bool() const { return normal != glm::vec3(0); }
};

/// Sums over positions, from a place nearby.
struct Moments {
    double count = 0;
    glm::dvec3 sum{0};
    glm::dmat3 squares{0};

    void add(const glm::dvec3& d) {
        ++count;
        sum += d;
        squares += glm::outerProduct(d, d);
    }
    /// Of another, from a place that is `by` away.
    void add(const Moments& other, const glm::dvec3& by) {
        count += other.count;
        sum += other.sum + other.count * by;
        squares += other.squares + glm::outerProduct(other.sum, by) + glm::outerProduct(by, other.sum) +
                   other.count * glm::outerProduct(by, by);
    }
};

struct Plane {
    glm::dvec3 normal{0};  ///< 0: none
    glm::dvec3 middle{0};
};

Plane planeOf(const Moments& m) {
    if (m.count < fewest) return {};
    const glm::dvec3 middle = m.sum / m.count;
    const glm::dmat3 v = m.squares / m.count - glm::outerProduct(middle, middle);
    const glm::dmat3 adjugate(glm::cross(v[1], v[2]), glm::cross(v[2], v[0]), glm::cross(v[0], v[1]));
    int longest = 0;
    for (int a = 1; a < 3; ++a)
        if (adjugate[a][a] > adjugate[longest][longest]) longest = a;
    // Its powers turn to the direction of the least variance.
    glm::dvec3 n = adjugate[longest];
    for (int step = 0; step < 6; ++step) {
        const double length = glm::length(n);
        if (!(length > 0)) return {};
        n = adjugate * (n / length);
    }
    if (!(glm::length(n) > 0)) return {};
    n = glm::normalize(n);
    const double thick = glm::dot(n, v * n), sum = v[0][0] + v[1][1] + v[2][2] - thick;
    const double product = adjugate[0][0] + adjugate[1][1] + adjugate[2][2] - thick * sum;
    const double width = (sum - std::sqrt(std::max(0.0, sum * sum - 4 * product))) / 2;
    if (thick > thickest * width || width < narrowest * (sum - width)) return {};
    return {n, middle};
}

/// The planes of all cells of one size that hold positions; each by the positions in it and in those around it.
class Cells {
  public:
    Cells(const NeighbourIndex& index, double size) : size_(size) {
        struct Entry {
            std::uint64_t cell;
            std::uint32_t position;
        };
        std::vector<Entry> entries(index.size());
        for (std::uint32_t p = 0; p < index.size(); ++p)
            entries[p] = {keyOf(cellOf(glm::dvec3(index.position(p)))), p};
        tbb::parallel_sort(entries, [](const Entry& a, const Entry& b) {
            return a.cell != b.cell ? a.cell < b.cell : a.position < b.position;
        });
        std::vector<Moments> moments;
        for (const Entry& e : entries) {
            if (keys_.empty() || keys_.back() != e.cell) {
                keys_.push_back(e.cell);
                moments.emplace_back();
            }
            moments.back().add(glm::dvec3(index.position(e.position)) - middleOf(cellOf(e.cell)));
        }
        planes_.resize(keys_.size());
        tbb::parallel_for(std::size_t(0), keys_.size(), [&](std::size_t i) {
            const glm::ivec3 cell = cellOf(keys_[i]);
            Moments window;
            forEachAround(cell, [&](const glm::ivec3& by) {
                if (const std::size_t j = find(cell + by); j != none)
                    window.add(moments[j], glm::dvec3(by) * size_);
            });
            planes_[i] = planeOf(window);
            planes_[i].middle += middleOf(cell);
        });
    }

    /// At a place, between the planes of cells nearby that are one with its own; none where that is none.
    Facing at(const glm::dvec3& place, double step) const {
        const glm::ivec3 cell = cellOf(place);
        const std::size_t own = find(cell);
        if (own == none || planes_[own].normal == glm::dvec3(0)) return {};
        const glm::dvec3 n = planes_[own].normal;
        if (std::abs(glm::dot(n, place - planes_[own].middle)) > mostSteps * step) return {};
        const glm::dvec3 from = place - middleOf(cell);
        glm::dvec3 sum(0);
        for (int corner = 0; corner < 8; ++corner) {
            glm::ivec3 by(0);
            double weight = 1;
            for (int a = 0; a < 3; ++a) {
                const double to = std::abs(from[a]) / size_;
                if (corner >> a & 1) by[a] = from[a] < 0 ? -1 : 1;
                weight *= by[a] ? to : 1 - to;
            }
            const std::size_t j = find(cell + by);
            if (j == none) continue;
            const double along = glm::dot(planes_[j].normal, n);
            if (std::abs(along) > same) sum += (along < 0 ? -weight : weight) * planes_[j].normal;
        }
        sum = glm::normalize(sum);
        return {glm::vec3(sum), float(glm::dot(sum, planes_[own].middle))};
    }

  private:
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    static constexpr int half = 1 << 20;

    glm::ivec3 cellOf(const glm::dvec3& place) const {
        return glm::ivec3(glm::clamp(glm::floor(place / size_), glm::dvec3(2 - half), glm::dvec3(half - 2)));
    }
    static std::uint64_t keyOf(const glm::ivec3& c) {
        return std::uint64_t(c.x + half) << 42 | std::uint64_t(c.y + half) << 21 | std::uint64_t(c.z + half);
    }
    static glm::ivec3 cellOf(std::uint64_t key) {
        const auto part = [&](int shift) { return int(key >> shift & (2 * half - 1)) - half; };
        return {part(42), part(21), part(0)};
    }
    glm::dvec3 middleOf(const glm::ivec3& c) const { return (glm::dvec3(c) + 0.5) * size_; }
    std::size_t find(const glm::ivec3& c) const {
        const auto at = std::lower_bound(keys_.begin(), keys_.end(), keyOf(c));
        return at != keys_.end() && *at == keyOf(c) ? std::size_t(at - keys_.begin()) : none;
    }
    template <class F>
    static void forEachAround(const glm::ivec3&, const F& f) {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) f(glm::ivec3(x, y, z));
    }

    double size_;
    std::vector<std::uint64_t> keys_;
    std::vector<Plane> planes_;
};

/// Of each position, the plane through the layers around it.
std::vector<Facing> planesThrough(const NeighbourIndex& index, const Steps& steps) {
    // Scales are powers of two, whatever the cloud's unit: a chunk's cells are as large as its neighbours'.
    const auto scaleOf = [&](std::uint32_t p) { return int(std::floor(std::log2(stepsPerCell * steps[p]))); };
    int finest = std::numeric_limits<int>::max(), coarsest = std::numeric_limits<int>::min();
    for (std::uint32_t p = 0; p < index.size(); ++p) {
        finest = std::min(finest, scaleOf(p));
        coarsest = std::max(coarsest, scaleOf(p));
    }
    finest = std::max(finest - tries + 1, coarsest - mostScales + 1);
    std::vector<Facing> facings(index.size());
    for (int scale = coarsest; scale >= finest; --scale) {
        const Cells cells(index, std::ldexp(1.0, scale));
        tbb::parallel_for(std::uint32_t(0), index.size(), [&](std::uint32_t p) {
            const int own = scaleOf(p);
            if (scale > own || scale <= own - tries || facings[p]) return;
            facings[p] = cells.at(glm::dvec3(index.position(p)), steps[p]);
        });
    }
    return facings;
}

/// Who is in no window's plane, but in that of who stands beside him, gets it: planes end where another one begins.
void grow(const NeighbourIndex& index, const Evidence& evidence, const Steps& steps,
          std::vector<Facing>& facings) {
    std::vector<std::uint32_t> without;
    for (std::uint32_t p = 0; p < index.size(); ++p)
        if (!facings[p]) without.push_back(p);
    std::vector<Facing> found;
    for (int round = 0; round < growingRounds; ++round) {
        found.assign(without.size(), {});
        tbb::parallel_for(std::size_t(0), without.size(), [&](std::size_t i) {
            const std::uint32_t p = without[i];
            float nearest = inPlane * steps[p];
            for (const std::uint32_t w : evidence.witnesses(p)) {
                if (!facings[w]) continue;
                const float far =
                    std::abs(glm::dot(facings[w].normal, index.position(p)) - facings[w].offset);
                if (far >= nearest) continue;
                nearest = far;
                found[i] = facings[w];
            }
        });
        std::size_t left = 0;
        for (std::size_t i = 0; i < without.size(); ++i) {
            if (found[i])
                facings[without[i]] = found[i];
            else
                without[left++] = without[i];
        }
        if (left == without.size()) return;
        without.resize(left);
    }
}

/// Any direction in the plane.
glm::vec3 across(const glm::vec3& normal) {
    return glm::normalize(
        glm::cross(normal, std::abs(normal.z) < 0.7f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0)));
}

}  // namespace

void seeThroughLayers(const NeighbourIndex& index, Evidence& evidence, std::span<Surfel> surfels) {
    Steps steps;
    for (int axis = 0; axis < 3 && steps.empty(); ++axis) steps = stepsAlong(index, evidence, axis);
    if (steps.empty()) return;
    auto facings = planesThrough(index, steps);
    grow(index, evidence, steps, facings);
    std::size_t planes = 0, others = 0;
    for (std::uint32_t p = 0; p < index.size(); ++p) {
        if (!facings[p]) continue;
        ++planes;
        others += std::abs(glm::dot(facings[p].normal, evidence.normal(p))) < float(same);
    }
    if (others * oneOf < planes) return;
    tbb::parallel_for(std::uint32_t(0), index.size(), [&](std::uint32_t p) {
        if (!facings[p]) return;
        evidence.setNormal(p, facings[p].normal);
        for (const std::uint32_t i : index.pointsAt(p))
            if (i < surfels.size()) {
                surfels[i].normal = facings[p].normal;
                surfels[i].majorAxis = across(facings[p].normal);
                surfels[i].minor = surfels[i].major;
                surfels[i].density = Density::Surface;
            }
    });
}

}  // namespace scancast
