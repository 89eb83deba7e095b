#include <algorithm>
#include <array>
#include <glm/common.hpp>

#include "renderer/cloud/build/nodes/spacing.hpp"
#include "renderer/cloud/build/nodes/subtree.hpp"
#include "renderer/cloud/surfel_bytes.hpp"

namespace scancast {

namespace {

std::uint64_t cellsBelow(const BuildNode& node, int cellLevel) {
    std::uint64_t n = 0;
    for (const auto& child : node.children) n += child->content.cells.cells(cellLevel);
    return n;
}

/// The cell size: the finest cell level, not below any child's, that leaves at most every second sample (and at
/// most twice a full leaf), so that every level is markedly coarser than the one below it and nodes hold
/// thousands of samples wherever the tree is deep. Steps must not be larger than that: what lies between two
/// levels is drawn at the finer one, and a step of three costs a view of a town half as many samples again.
/// Few samples (an eighth of a leaf) need not be made fewer. A cell is at least 32 lattice steps wide:
/// positions are then exact to 0.05 of the spacing.
int chooseCellLevel(const BuildNode& node, const InnerLattice& lattice, const OctreeInput& input) {
    int cellLevel = std::max(0, lattice.cellLevel + 5);
    std::uint64_t below = 0;
    for (const auto& child : node.children) {
        cellLevel = std::max(cellLevel, child->content.cellLevel);
        below += child->stored.node.sampleCount;
    }
    const std::uint64_t full = std::max(input.shape.leafPoints, 16u);
    const std::uint64_t most = std::min(full * 2, std::max(below / 2, full / 8));
    while (cellLevel < gridBits && cellsBelow(node, cellLevel) > most) ++cellLevel;
    return cellLevel;
}

AverageList averageChildren(BuildNode& node, int cellLevel, const AverageRules& all) {
    AverageList runs{.cellLevel = cellLevel, .averages = {}, .votes = {}};
    std::vector<std::size_t> starts;
    for (auto& child : node.children) {
        starts.push_back(runs.averages.size());
        AverageRules rules = all;
        rules.sides = !all.oriented || child->confidence >= sureSide;
        if (child->isLeaf())
            appendCells(child->points, child->content.beside, rules, runs);
        else
            appendCells(child->averages, rules, runs);
        child->averages = {};
        child->points = {};
        giveBack(child->keptPoints);
    }
    return merge(runs, starts, all);
}

/// As sure as those children are that are.
std::uint8_t confidenceBelow(const BuildNode& node) {
    double sum = 0, weight = 0;
    for (const auto& child : node.children) {
        if (child->confidence < sureSide) continue;
        sum += double(child->confidence) * double(child->surePoints);
        weight += double(child->surePoints);
    }
    return std::uint8_t(sum / weight);
}

/// A normal that is the sum of few, or of normals that contradict each other, is nobody's side.
bool isUnsure(const Average& average) {
    constexpr double unit = 4096, least = 0.5;
    double squared = 0;
    for (const std::int64_t n : average.normal) squared += double(n) * double(n);
    return squared < (least * unit * double(average.count)) * (least * unit * double(average.count));
}

Density densityOf(Bulk bulk) {
    constexpr std::array densities{Density::Surface, Density::Wire, Density::Foliage, Density::Stray};
    return densities[std::size_t(bulk)];
}

void fillSamples(BuildNode& node, const InnerLattice& lattice, const OctreeInput& input) {
    const Grid& grid = input.grid;
    const glm::dvec3 boxLow = grid.toFile(node.box.min) - input.origin;
    std::vector<glm::vec3> local;
    local.reserve(node.averages.averages.size());
    node.content.samples.reserve(node.averages.averages.size());
    for (const Average& average : node.averages.averages) {
        const glm::dvec3 offset = meanPosition(average, node.box.min) * grid.step;
        local.emplace_back(offset);
        Sample s = meanAttributes(average, node.averages);
        const auto q = lattice.quantise(boxLow + offset);
        s.x = q[0], s.y = q[1], s.z = q[2];
        if (input.shape.surfels && node.confidence >= sureSide && node.confidence < certainSide &&
            isUnsure(average))
            s.ellipse = twoSidedCircle;
        node.content.samples.push_back(s);
        if (input.nearInfrared) node.content.beside.push_back(withNearInfrared(0, meanNearInfrared(average)));
        if (!input.shape.surfels) continue;
        node.content.reaches.push_back(average.reach);
        node.content.densities.push_back(densityOf(bulkOf(average)));
    }
    // Cells that are all filled are a cell apart; where the scan is sparse or oblique to them, the gaps
    // decide.
    const Spacing spacing = estimateSpacing(local);
    node.content.spacing = std::max(grid.cellSize(node.averages.cellLevel), spacing.closing);
    node.content.meanSpacing = spacing.mean > 0 ? spacing.mean : node.content.spacing;
}

}  // namespace

void fillInner(BuildNode& node, const OctreeInput& input) {
    std::vector<Bounds> below;
    node.pointCount = 0;
    glm::dvec3 low(1e300), high(-1e300);
    for (const auto& child : node.children) {
        below.push_back(child->content.bounds);
        node.box.add(child->box);
        node.pointCount += child->pointCount;
        low = glm::min(low, child->content.bounds.low);
        high = glm::max(high, child->content.bounds.high);
    }
    const InnerLattice lattice = innerLattice(low, high, input.grid);
    NodeContent& content = node.content;
    content.cellLevel = chooseCellLevel(node, lattice, input);
    for (const auto& child : node.children) node.surePoints += child->surePoints;
    if (mostlySure(node.surePoints, node.pointCount)) node.confidence = confidenceBelow(node);
    const AverageRules rules{.attributes = input.attributes,
                             .oriented = node.confidence >= sureSide,
                             .reach = input.shape.surfels,
                             .gridStep = input.grid.step};
    node.averages = averageChildren(node, content.cellLevel, rules);
    content.corner = lattice.corner;
    content.step = lattice.step;
    fillSamples(node, lattice, input);
    const auto& list = node.averages.averages;
    content.cells.addFirst();
    for (std::size_t i = 1; i < list.size(); ++i)
        content.cells.addStep(list[i - 1].cell, list[i].cell, content.cellLevel);
    content.bounds = boundsOf(content.samples, content.corner, content.step, below);
    node.stored.node.sampleCount = std::uint32_t(content.samples.size());
}

}  // namespace scancast
