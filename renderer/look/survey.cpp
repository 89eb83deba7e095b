#include "renderer/look/survey.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <queue>

#include "renderer/cloud/build/nodes/tangent_plane.hpp"

namespace scancast {

namespace {

/// Nodes read at most: what lies deeper says nothing about a picture as a whole.
constexpr std::size_t mostNodes = 256;

/// The nodes to look at: the coarsest is replaced by its children while there are too few samples.
std::vector<std::uint32_t> nodesToSurvey(const Octree& octree, std::size_t most) {
    const auto isFiner = [&](std::uint32_t a, std::uint32_t b) {
        const float left = octree.node(a).meanSpacing, right = octree.node(b).meanSpacing;
        return left != right ? left < right : a > b;
    };
    std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, decltype(isFiner)> coarsest(isFiner);
    std::vector<std::uint32_t> leaves;
    coarsest.push(0);
    std::size_t samples = octree.node(0).sampleCount;
    while (!coarsest.empty() && samples < most && coarsest.size() + leaves.size() < mostNodes) {
        const std::uint32_t i = coarsest.top();
        const Node& node = octree.node(i);
        coarsest.pop();
        if (node.isLeaf()) {
            leaves.push_back(i);
            continue;
        }
        samples -= node.sampleCount;
        for (std::uint32_t c = 0; c < node.childCount; ++c) {
            coarsest.push(node.firstChild + c);
            samples += octree.node(node.firstChild + c).sampleCount;
        }
    }
    for (; !coarsest.empty(); coarsest.pop()) leaves.push_back(coarsest.top());
    std::ranges::sort(leaves);
    return leaves;
}

/// Integer cell of a point in a grid over the box.
using Cell = std::array<int, 3>;

/// Groups of neighbouring cells of a grid, by size.
class Groups {
  public:
    Groups(const std::vector<SurveyPoint>& points, const glm::dvec3& corner, double cellSize)
        : corner_(corner), cellSize_(cellSize) {
        for (const SurveyPoint& p : points) ++cells_[cellOf(p.position)].points;
        for (auto& [cell, content] : cells_)
            if (content.group < 0) flood(cell);
    }

    std::size_t sizeAround(const glm::dvec3& position) const {
        return sizes_[std::size_t(cells_.at(cellOf(position)).group)];
    }

  private:
    struct Content {
        std::size_t points = 0;
        int group = -1;
    };

    Cell cellOf(const glm::dvec3& position) const {
        const glm::dvec3 at = (position - corner_) / cellSize_;
        return {int(std::floor(at.x)), int(std::floor(at.y)), int(std::floor(at.z))};
    }

    /// Gives a group to everything that touches, or is one empty cell away.
    void flood(const Cell& start) {
        const int group = int(sizes_.size());
        sizes_.push_back(0);
        std::vector<Cell> open{start};
        cells_[start].group = group;
        while (!open.empty()) {
            const Cell at = open.back();
            open.pop_back();
            sizes_.back() += cells_[at].points;
            for (int n = 0; n < 125; ++n) {
                const auto found =
                    cells_.find({at[0] + n % 5 - 2, at[1] + n / 5 % 5 - 2, at[2] + n / 25 - 2});
                if (found == cells_.end() || found->second.group >= 0) continue;
                found->second.group = group;
                open.push_back(found->first);
            }
        }
    }

    const glm::dvec3 corner_;
    const double cellSize_;
    std::map<Cell, Content> cells_;
    std::vector<std::size_t> sizes_;
};

/// Leaves those for which `keep` says so, unless hardly any would stay.
template <class Keep>
void keepMost(std::vector<SurveyPoint>& points, Keep keep) {
    std::vector<SurveyPoint> kept;
    std::ranges::copy_if(points, std::back_inserter(kept), keep);
    if (4 * kept.size() >= 3 * points.size()) points = std::move(kept);
}

bool isNoise(const SurveyPoint& point) {
    return point.classification == 7 || point.classification == 18;
}

/// Where nearly all points are, and as much again on each side: what lies outside is far from everything.
std::array<glm::dvec3, 2> neighbourhood(const std::vector<SurveyPoint>& points) {
    std::array<glm::dvec3, 2> box;
    glm::dvec3 size;
    for (int a = 0; a < 3; ++a) {
        std::vector<double> values;
        for (const SurveyPoint& p : points) values.push_back(p.position[a]);
        box[0][a] = quantileOf(values, 0.01);
        box[1][a] = quantileOf(std::move(values), 0.99);
        size[a] = box[1][a] - box[0][a];
    }
    const double largest = std::max({size.x, size.y, size.z});
    const glm::dvec3 around = glm::max(size, glm::dvec3(largest * 0.5));
    return {box[0] - around, box[1] + around};
}

/// Leaves that noise is measured in, points in each, and neighbours of each of these: enough to see through the
/// layers in which depth cameras count.
constexpr std::size_t noiseLeaves = 8, noisePoints = 48, noiseNeighbours = 48;

/// A value for every neighbour.
using Column = std::array<double, noiseNeighbours>;
double dotOf(const Column& a, const Column& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}
void removeFrom(Column& column, const Column& unit) {
    const double along = dotOf(column, unit);
    for (std::size_t i = 0; i < column.size(); ++i) column[i] -= along * unit[i];
}

/// Root mean square of heights over a plane less those of the paraboloid through them, by Gram and Schmidt: a curved
/// surface is no noise. What the fit takes of the noise is made up for.
double deviationFromParaboloid(const std::vector<glm::vec3>& offsets, const TangentPlane& plane) {
    const glm::dvec3 u = plane.first, v = plane.second, n = glm::cross(u, v);
    std::array<Column, 6> basis;
    Column heights;
    for (std::size_t i = 0; i < noiseNeighbours; ++i) {
        const glm::dvec3 p(offsets[i]);
        const double a = glm::dot(p, u), b = glm::dot(p, v);
        const double terms[] = {1, a, b, a * a, a * b, b * b};
        for (std::size_t k = 0; k < basis.size(); ++k) basis[k][i] = terms[k];
        heights[i] = glm::dot(p, n);
    }
    std::size_t used = 0;
    for (std::size_t k = 0; k < basis.size(); ++k) {
        const double before = dotOf(basis[k], basis[k]);
        for (std::size_t earlier = 0; earlier < used; ++earlier) removeFrom(basis[k], basis[earlier]);
        const double left = dotOf(basis[k], basis[k]);
        if (!(left > 1e-9 * before)) continue;
        basis[used] = basis[k];
        for (double& value : basis[used]) value /= std::sqrt(left);
        removeFrom(heights, basis[used++]);
    }
    return std::sqrt(dotOf(heights, heights) / double(noiseNeighbours - used));
}

/// Of some samples: deviation of the nearest neighbours from their surface.
void addDeviations(const Node& node, std::span<const Sample> samples, std::vector<double>& deviations) {
    if (samples.size() <= noiseNeighbours) return;
    std::vector<std::pair<double, std::size_t>> near(samples.size());
    std::vector<glm::vec3> offsets;
    for (std::size_t q = 0; q < noisePoints; ++q) {
        const glm::dvec3 at = position(node, samples[q * samples.size() / noisePoints]);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const glm::dvec3 to = position(node, samples[i]) - at;
            near[i] = {glm::dot(to, to), i};
        }
        std::ranges::nth_element(near, near.begin() + std::ptrdiff_t(noiseNeighbours));
        offsets.clear();
        for (std::size_t i = 0; i < noiseNeighbours; ++i)
            offsets.emplace_back(position(node, samples[near[i].second]) - at);
        deviations.push_back(deviationFromParaboloid(offsets, tangentPlane(offsets)));
    }
}

}  // namespace

double noiseOf(const Cloud& cloud) {
    std::vector<std::uint32_t> leaves;
    for (std::uint32_t i = 0; i < cloud.octree.nodes().size(); ++i)
        if (cloud.octree.node(i).isLeaf()) leaves.push_back(i);
    std::vector<double> deviations;
    for (std::size_t k = 0; k < noiseLeaves && k < leaves.size(); ++k) {
        const std::uint32_t leaf = leaves[k * leaves.size() / std::min(noiseLeaves, leaves.size())];
        if (const auto run = cloud.octree.run(leaf))
            addDeviations(cloud.octree.node(leaf), run->samples, deviations);
    }
    return deviations.empty() ? 0 : quantileOf(std::move(deviations), 0.5);
}

double quantileOf(std::vector<double> values, double q) {
    const auto at = values.begin() + std::ptrdiff_t(q * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

std::array<glm::dvec3, 2> boxOf(const std::vector<SurveyPoint>& points) {
    std::array<glm::dvec3, 2> box{points.front().position, points.front().position};
    for (const SurveyPoint& p : points) box = {glm::min(box[0], p.position), glm::max(box[1], p.position)};
    return box;
}

std::vector<SurveyPoint> survey(const Cloud& cloud, std::size_t most) {
    std::vector<SurveyPoint> points;
    if (cloud.octree.nodes().empty()) return points;
    const auto nodes = nodesToSurvey(cloud.octree, most);
    std::size_t samples = 0;
    for (const std::uint32_t i : nodes) samples += cloud.octree.node(i).sampleCount;
    const std::size_t stride = std::max<std::size_t>(1, samples / most);
    std::size_t next = 0;
    for (const std::uint32_t i : nodes) {
        const Node& node = cloud.octree.node(i);
        const auto run = cloud.octree.run(i);
        if (!run) continue;
        for (; next < run->samples.size(); next += stride) {
            const Sample& s = run->samples[next];
            points.push_back({cloud.origin + position(node, s), decodeNormal(s.normal), node.meanSpacing,
                              s.classification});
        }
        next -= run->samples.size();
    }
    return points;
}

std::vector<SurveyPoint> withoutStrays(std::vector<SurveyPoint> points) {
    if (points.size() < 100) return points;
    keepMost(points, [](const SurveyPoint& p) { return !isNoise(p); });
    const auto near = neighbourhood(points);
    keepMost(points, [&](const SurveyPoint& p) {
        return glm::all(glm::greaterThanEqual(p.position, near[0])) &&
               glm::all(glm::lessThanEqual(p.position, near[1]));
    });
    const auto box = boxOf(points);
    const glm::dvec3 size = box[1] - box[0];
    const double cell = std::max({size.x, size.y, size.z}) / 64;
    if (!(cell > 0)) return points;
    const Groups groups(points, box[0], cell);
    const std::size_t few = points.size() / 100;
    keepMost(points, [&](const SurveyPoint& p) { return groups.sizeAround(p.position) >= few; });
    return points;
}

}  // namespace scancast
