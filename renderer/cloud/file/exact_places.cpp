#include "renderer/cloud/file/exact_places.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "files/bytes.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/file/cloud_file.hpp"

namespace scancast {

namespace {

/// Lattice steps are those of the grid times a power of two, computed in doubles.
constexpr double sameLatticeStep = 1 + 1e-9;

/// Which of the file's planes these are; nullopt unless all are there.
std::optional<std::array<std::size_t, 3>> findPlanes(const CloudFile& file,
                                                     const std::array<ValuePlane, 3>& wanted) {
    std::array<std::size_t, 3> found{};
    for (std::size_t a = 0; a < 3; ++a) {
        const auto at = std::ranges::find(file.planes(), wanted[a]);
        if (at == file.planes().end()) return std::nullopt;
        found[a] = std::size_t(at - file.planes().begin());
    }
    return found;
}

}  // namespace

bool roundsPositions(const Node& leaf, const std::optional<ScanGrid>& grid, int axis) {
    return !grid || leaf.step[axis] > grid->step[axis] * sameLatticeStep;
}

bool roundsPositions(const Node& leaf, const std::optional<ScanGrid>& grid) {
    for (int axis = 0; axis < 3; ++axis)
        if (roundsPositions(leaf, grid, axis)) return true;
    return false;
}

ExactPlaces::ExactPlaces(const CloudFacts& facts, const CloudFile* file) : facts_(facts), file_(file) {
    if (file == nullptr) return;
    if (facts.grid && hasGridPlanes(facts)) grid_ = findPlanes(*file, gridPlanes());
    if (!facts.exact) return;
    std::array<ValuePlane, 3> columns;
    for (std::size_t a = 0; a < 3; ++a)
        columns[a] = {std::string(exactPositionNames[a]), ColumnType::Float64, ValuePlane::Of::Points};
    doubles_ = findPlanes(*file, columns);
}

bool ExactPlaces::isExact(const Node& leaf) const {
    return doubles_ || (facts_.grid && (grid_ || !roundsPositions(leaf, facts_.grid)));
}

glm::dvec3 ExactPlaces::precision(const Node& leaf, const glm::dvec3& place) const {
    if (!isExact(leaf)) return leaf.step;
    if (!doubles_) return facts_.grid->step;
    glm::dvec3 step;
    for (int a = 0; a < 3; ++a)
        step[a] =
            std::nextafter(std::abs(place[a]), std::numeric_limits<double>::infinity()) - std::abs(place[a]);
    return step;
}

template <class T, class Place>
Expected<void> ExactPlaces::byPlanes(std::uint32_t leaf, std::size_t count, const Planes& planes,
                                     Place place) const {
    for (int a = 0; a < 3; ++a) {
        const auto values = file_->plane(leaf, (*planes)[std::size_t(a)]);
        if (!values) return passOn(values);
        if (values->size() != count * sizeof(T))
            return fail(ErrorCode::Malformed, file_->path().string() +
                                                  " has no positions beside the samples "
                                                  "of a node that rounds them; the file is damaged");
        for (std::size_t i = 0; i < count; ++i)
            place(i, a, double(loadLe<T>(values->data() + i * sizeof(T))));
    }
    return {};
}

Expected<void> ExactPlaces::of(std::uint32_t leaf, const Node& node, std::span<const Sample> samples,
                               std::span<glm::dvec3> places) const {
    if (doubles_)
        return byPlanes<double>(leaf, samples.size(), doubles_,
                                [&](std::size_t i, int a, double value) { places[i][a] = value; });
    if (!roundsPositions(node, facts_.grid)) {
        // On the grid: the very numbers that the scan's reader had.
        const ScanGrid& grid = *facts_.grid;
        const glm::dvec3 start = (facts_.origin + node.boxMin - grid.origin) / grid.step;
        const glm::dvec3 step = node.step / grid.step;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Sample& s = samples[i];
            const glm::dvec3 q = glm::round(start + step * glm::dvec3(s.x, s.y, s.z));
            places[i] = grid.origin + q * grid.step;
        }
        return {};
    }
    if (grid_) {
        const ScanGrid& grid = *facts_.grid;
        return byPlanes<std::int32_t>(leaf, samples.size(), grid_, [&](std::size_t i, int a, double value) {
            places[i][a] = grid.origin[a] + value * grid.step[a];
        });
    }
    for (std::size_t i = 0; i < samples.size(); ++i) places[i] = facts_.origin + position(node, samples[i]);
    return {};
}

}  // namespace scancast
