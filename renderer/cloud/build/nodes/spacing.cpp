#include "renderer/cloud/build/nodes/spacing.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "renderer/cloud/build/nodes/tangent_plane.hpp"
#include "renderer/cloud/build/nodes/voronoi_cell.hpp"

namespace scancast {

namespace {

constexpr std::size_t queries = 64;
constexpr std::size_t blockSize = 32;
constexpr std::size_t fewest = 24, most = 400;  // neighbours that make a neighbourhood

// A square grid's Voronoi cell reaches pitch / √2 far. The quantile and the factor make discs of the
// resulting radius cover a grid with a margin of √2 and randomly placed samples but for about one part in
// 5,000.
constexpr double quantile = 0.85;
constexpr double pitchPerReach = 1.4142135623730951;

/// Boxes around runs of samples, each bound of all of them side by side.
struct SampleBoxes {
    std::array<std::vector<float>, 3> low, high;
    std::size_t size() const { return low[0].size(); }
};

SampleBoxes boxesOf(std::span<const glm::vec3> samples) {
    SampleBoxes boxes;
    for (int a = 0; a < 3; ++a) {
        boxes.low[a].reserve(samples.size() / blockSize + 1);
        boxes.high[a].reserve(samples.size() / blockSize + 1);
    }
    for (std::size_t i = 0; i < samples.size(); i += blockSize) {
        glm::vec3 low = samples[i], high = low;
        for (const glm::vec3& p : samples.subspan(i, std::min(blockSize, samples.size() - i))) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        for (int a = 0; a < 3; ++a) {
            boxes.low[a].push_back(low[a]);
            boxes.high[a].push_back(high[a]);
        }
    }
    return boxes;
}

/// Of a place to every box.
void squaredDistances(const SampleBoxes& boxes, const glm::vec3& p, std::vector<float>& out) {
    out.resize(boxes.size());
    float* const to = out.data();
    const std::array<const float*, 3> low{boxes.low[0].data(), boxes.low[1].data(), boxes.low[2].data()};
    const std::array<const float*, 3> high{boxes.high[0].data(), boxes.high[1].data(), boxes.high[2].data()};
    const auto along = [&](std::size_t a, std::size_t i) {
        const float below = low[a][i] - p[int(a)], above = p[int(a)] - high[a][i];
        const float d = below < above ? above : below;
        return d < 0 ? 0.0f : d;
    };
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const float x = along(0, i), y = along(1, i), z = along(2, i);
        to[i] = x * x + y * y + z * z;
    }
}

/// The neighbours of samples[at] within a radius, as offsets; equal samples are left out. Stops early past
/// `most`.
void gather(std::span<const glm::vec3> samples, std::span<const float> fromBoxes, std::size_t at,
            float radius, std::vector<glm::vec3>& out) {
    out.clear();
    const glm::vec3 p = samples[at];
    const float limit = radius * radius;
    for (std::size_t b = 0; b < fromBoxes.size() && out.size() <= most; ++b) {
        if (fromBoxes[b] > limit) continue;
        for (const glm::vec3& q :
             samples.subspan(b * blockSize, std::min(blockSize, samples.size() - b * blockSize))) {
            const glm::vec3 d = q - p;
            const float distance = glm::dot(d, d);
            if (distance <= limit && distance > 0) out.push_back(d);
        }
    }
}

struct Neighbourhood {
    TangentPlane plane;
    float radius;  ///< everything nearer than this was found
};

class Neighbourhoods {
  public:
    explicit Neighbourhoods(std::span<const glm::vec3> samples)
        : samples_(samples), blocks_(boxesOf(samples)) {
        glm::vec3 size;
        for (int a = 0; a < 3; ++a)
            size[a] = *std::ranges::max_element(blocks_.high[a]) - *std::ranges::min_element(blocks_.low[a]);
        largest_ = glm::length(size);
    }

    bool empty() const { return !(largest_ > 0); }

    /// Neighbours enough to see the surface around a sample: at least `fewest`, and more while they lie on
    /// one line (a scan line whose neighbours are farther than its points).
    Neighbourhood find(std::size_t at, std::vector<glm::vec3>& out) {
        float radius = guess_ > 0 ? guess_ : firstGuess(at);
        float tooMany = std::numeric_limits<float>::infinity();
        bool line = false;
        TangentPlane plane;
        squaredDistances(blocks_, samples_[at], fromBlocks_);
        for (int tries = 0; tries < 40; ++tries) {
            gather(samples_, fromBlocks_, at, radius, out);
            if (out.size() > most) {
                tooMany = radius;
                radius *= 0.6f;
                continue;
            }
            plane = tangentPlane(out);
            const bool isLine = plane.variance[1] * 16 < plane.variance[0];
            if (radius >= largest_ || (out.size() >= fewest && !isLine) || radius * 1.35f >= tooMany) break;
            line = line || (out.size() >= fewest && isLine);
            radius *= 1.35f;
        }
        // The next neighbourhood is probably like this one; where lines are, it needs as many again.
        const float wanted = std::sqrt(1.5f * float(fewest) / float(std::max<std::size_t>(out.size(), 1)));
        guess_ = line ? radius : radius * std::clamp(wanted, 0.5f, 1.5f);
        return {plane, radius};
    }

  private:
    float firstGuess(std::size_t at) const {
        glm::vec3 sizes;
        for (int a = 0; a < 3; ++a)
            sizes[a] = blocks_.high[a][at / blockSize] - blocks_.low[a][at / blockSize];
        const float size = glm::length(sizes);
        return size > 0 ? size : largest_ * 1e-3f;
    }

    std::span<const glm::vec3> samples_;
    SampleBoxes blocks_;
    std::vector<float> fromBlocks_;  ///< squared distances of the sample that is asked for
    float largest_ = 0, guess_ = 0;
};

struct CellSize {
    double reach, area;
};

/// How far the Voronoi cell of the origin among these neighbours reaches, and its area; nothing where it is
/// open.
std::optional<CellSize> cellSize(std::span<const glm::vec3> offsets, const TangentPlane& plane,
                                 double radius) {
    thread_local std::vector<glm::dvec2> flat;
    flat.clear();
    for (const glm::vec3& o : offsets)
        flat.emplace_back(glm::dot(glm::dvec3(o), plane.first), glm::dot(glm::dvec3(o), plane.second));
    std::sort(flat.begin(), flat.end(),
              [](const glm::dvec2& a, const glm::dvec2& b) { return glm::dot(a, a) < glm::dot(b, b); });
    VoronoiCell cell(radius);
    for (const glm::dvec2& f : flat) {
        if (glm::dot(f, f) > 4 * cell.squaredReach()) break;
        cell.cut(f);
    }
    if (cell.isOpen()) return std::nullopt;
    return CellSize{std::sqrt(cell.squaredReach()), cell.area()};
}

/// What stands for the reach where cells are open: half the way to the second nearest, as along a line.
double lineReach(std::span<const glm::vec3> offsets) {
    std::array<double, 2> nearest{1e300, 1e300};
    for (const glm::vec3& o : offsets) {
        const double d = glm::length(glm::dvec3(o));
        if (d < nearest[0])
            nearest = {d, nearest[0]};
        else
            nearest[1] = std::min(nearest[1], d);
    }
    return (nearest[1] < 1e300 ? nearest[1] : nearest[0]) / pitchPerReach;
}

double quantileOf(std::vector<double>& values) {
    const auto at = values.begin() + std::ptrdiff_t(quantile * double(values.size() - 1) + 0.5);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

Spacing estimateSpacing(std::span<const glm::vec3> samples) {
    if (samples.size() < 2) return {};
    Neighbourhoods neighbourhoods(samples);
    if (neighbourhoods.empty()) return {};
    std::vector<double> closed, open;
    double area = 0;
    std::vector<glm::vec3> offsets;
    const std::size_t count = std::min(samples.size(), queries);
    for (std::size_t i = 0; i < count; ++i) {
        const auto [plane, radius] = neighbourhoods.find((2 * i + 1) * samples.size() / (2 * count), offsets);
        if (offsets.empty()) continue;
        if (const auto cell = cellSize(offsets, plane, radius)) {
            closed.push_back(cell->reach);
            area += cell->area;
        } else {
            open.push_back(lineReach(offsets));
        }
    }
    const bool isSurface = closed.size() * 4 >= count;
    std::vector<double>& reaches = isSurface ? closed : open;
    if (reaches.empty()) return {};
    const double closing = quantileOf(reaches) * pitchPerReach;
    const double mean = isSurface ? std::sqrt(area / static_cast<double>(closed.size())) : closing;
    return {std::min(mean, closing), closing};
}

double typicalSpacing(std::span<const StoredNode> nodes) {
    std::vector<std::pair<float, std::uint64_t>> leaves;
    std::uint64_t points = 0;
    for (const StoredNode& n : nodes) {
        if (!n.node.isLeaf()) continue;
        leaves.emplace_back(n.node.meanSpacing, n.node.points);
        points += n.node.points;
    }
    std::sort(leaves.begin(), leaves.end());
    std::uint64_t below = 0;
    for (const auto& [spacing, count] : leaves) {
        below += count;
        if (2 * below >= points) return spacing;
    }
    return 0;
}

}  // namespace scancast
