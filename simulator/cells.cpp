#include "simulator/cells.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace scancast {
namespace {

constexpr float skyReach = 2.2F;  ///< occluders nearer than this dim the sky (twice 1.1 m: lighting.cpp)
constexpr std::size_t mostOccluders = 24;  ///< of each kind, a cell

/// Occluders that matter for anything within `radius` of `at`. Bounding balls only: a superset is enough.
void gather(const Model& model, glm::vec3 at, float radius, const std::vector<std::uint32_t>& from,
            std::vector<std::uint32_t>& shadows, std::vector<std::uint32_t>& near) {
    shadows.clear();
    near.clear();
    for (const std::uint32_t index : from) {
        const Occluder& body = model.occluders[index];
        const glm::vec3 to = body.center - at;
        const float reach = body.radius + radius;
        const bool sun = model.light.kind == Light::Kind::Sun;
        const glm::vec3 path = sun ? model.light.towards : model.light.towards - at;
        const float along =
            sun ? std::max(0.0F, glm::dot(to, path))
                : std::clamp(glm::dot(to, path) / std::max(1e-9F, glm::dot(path, path)), 0.0F, 1.0F);
        const glm::vec3 gap = to - path * along;
        if (glm::dot(gap, gap) < reach * reach) shadows.push_back(index);
        if (body.planeCount > 0 && glm::length(to) < reach + skyReach &&
            body.distance(at) < radius + skyReach)
            near.push_back(index);
    }
}

bool clearWay(const Model& model, glm::vec3 from, glm::vec3 to) {
    const float reach = glm::distance(from, to);
    if (reach < 1e-3F) return true;
    const glm::vec3 direction = (to - from) / reach;
    return std::ranges::none_of(model.occluders, [&](const Occluder& body) {
        return body.planeCount > 0 && body.blocks(from, direction, reach);
    });
}

/// The nearest station that sees the cell from its front; failing that the nearest one on its front; or just
/// any.
std::uint16_t stationFor(const Model& model, const SurfacePoint& center) {
    constexpr std::size_t candidates = 3;
    std::array<std::pair<double, std::size_t>, candidates> best;
    best.fill({1e300, 0});
    for (std::size_t i = 0; i < model.stations.size(); ++i) {
        const glm::dvec3 to = model.stations[i] - center.position;
        const bool facing = glm::dot(to, glm::dvec3(center.normal)) > 0;
        const double badness = glm::dot(to, to) * (facing ? 1 : 100);
        if (badness >= best.back().first) continue;
        best.back() = {badness, i};
        std::ranges::sort(best);
    }
    const glm::vec3 lifted = glm::vec3(center.position) + center.normal * 0.1F;
    for (const auto& [badness, index] : best)
        if (badness < 1e299 && clearWay(model, lifted, model.stations[index])) return std::uint16_t(index);
    return std::uint16_t(best.front().second);
}

/// The station that sees the cell in the mirror: whose straight beam to the mirrored place goes through the
/// glass.
std::optional<std::uint16_t> stationThroughMirror(const Model& model, const Mirror& mirror,
                                                  const glm::dvec3& at) {
    if (glm::dot(at - mirror.center, mirror.normal) <= 1e-6) return std::nullopt;
    const glm::dvec3 image = reflected(mirror, at), right = glm::cross(mirror.up, mirror.normal);
    for (std::size_t i = 0; i < model.stations.size(); ++i) {
        const glm::dvec3 beam = image - model.stations[i];
        const double along =
            glm::dot(mirror.center - model.stations[i], mirror.normal) / glm::dot(beam, mirror.normal);
        const glm::dvec3 on = model.stations[i] + beam * along - mirror.center;
        if (along > 0 && along < 1 && std::abs(glm::dot(on, right)) < mirror.width / 2 &&
            std::abs(glm::dot(on, mirror.up)) < mirror.height / 2)
            return std::uint16_t(i);
    }
    return std::nullopt;
}

/// What cutting one patch yields, before the cells of all patches are put in the scanner's order.
struct PatchCells {
    std::vector<Cell> cells;
    std::vector<std::uint64_t> keys;
    std::vector<std::uint32_t> occluders;
};

/// Whether what lies just before the surface is inside a building: ground under a house, walls between two
/// houses.
bool insideOccluder(const Model& model, const SurfacePoint& point) {
    const glm::vec3 at = glm::vec3(point.position) + point.normal * 0.4F;
    return std::ranges::any_of(
        model.occluders, [&](const Occluder& body) { return body.solid && body.distance(at) < -0.05F; });
}

PatchCells cutPatch(const Model& model, std::uint32_t index, std::uint32_t columns, std::uint32_t rows) {
    const Patch& patch = model.patches[index];
    const double cellRadius = 0.75 * std::hypot(patch.lengthU / columns, patch.lengthV / rows) + 0.5;
    const SurfacePoint middle = patch.at(0.5, 0.5);
    const auto patchRadius = float(std::hypot(patch.lengthU, patch.lengthV) + 0.5);
    std::vector<std::uint32_t> all(model.occluders.size()), shadows, near, here;
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    if (model.light.kind != Light::Kind::None) {
        gather(model, middle.position, patchRadius, all, shadows, near);
        std::ranges::set_union(shadows, near, std::back_inserter(here));
    }
    PatchCells result;
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            Cell cell{.patch = index, .column = std::uint16_t(column), .row = std::uint16_t(row)};
            const SurfacePoint center = patch.at((column + 0.5) / columns, (row + 0.5) / rows);
            if (patch.hideInside && insideOccluder(model, center)) continue;
            glm::dvec3 seen = center.position;
            if (patch.mirror >= 0) {
                const Mirror& mirror = model.mirrors[std::size_t(patch.mirror)];
                const auto station = stationThroughMirror(model, mirror, center.position);
                if (!station) continue;
                cell.station = *station;
                seen = reflected(mirror, seen);
            } else {
                cell.station = stationFor(model, center);
            }
            gather(model, center.position, float(cellRadius), here, shadows, near);
            shadows.resize(std::min(shadows.size(), mostOccluders));
            near.resize(std::min(near.size(), mostOccluders));
            cell.firstOccluder = std::uint32_t(result.occluders.size());
            cell.shadowCount = std::uint8_t(shadows.size());
            cell.nearCount = std::uint8_t(near.size());
            result.occluders.insert(result.occluders.end(), shadows.begin(), shadows.end());
            result.occluders.insert(result.occluders.end(), near.begin(), near.end());
            const BeamAngles beam = beamAngles(seen - model.stations[cell.station]);
            result.cells.push_back(cell);
            result.keys.push_back((std::uint64_t(cell.station) << 32) |
                                  (std::uint64_t(beam.azimuth * 720) << 16) |
                                  std::uint64_t(beam.elevation * 65535));
        }
    }
    return result;
}

}  // namespace

glm::dvec3 reflected(const Mirror& mirror, const glm::dvec3& at) {
    return at - mirror.normal * (2 * glm::dot(at - mirror.center, mirror.normal));
}

BeamAngles beamAngles(const glm::dvec3& d) {
    const double azimuth = std::atan2(d.x, d.y) / (2 * std::numbers::pi);
    const double elevation = std::atan2(d.z, std::hypot(d.x, d.y)) / std::numbers::pi + 0.5;
    return {std::min(azimuth < 0 ? azimuth + 1 : azimuth, 0x1.fffffep-1),
            std::clamp(elevation, 0.0, 0x1.fffffep-1)};
}

CellTable CellTable::build(const Model& model, std::uint64_t points) {
    CellTable table;
    table.points_ = points;
    double weighted = 0;
    for (const Patch& patch : model.patches) weighted += patch.area() * patch.density;
    table.spacing_ = std::sqrt(weighted / double(std::max<std::uint64_t>(1, points)));
    const double edge = std::clamp(4 * table.spacing_, model.smallestCell, model.largestCell);

    std::vector<PatchCells> parts(model.patches.size());
    table.grid_.resize(model.patches.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto pieces = [&](double length) {
            return std::uint32_t(std::clamp(std::ceil(length / edge - 1e-9), 1.0, 65535.0));
        };
        if (!model.patches[i].regular)
            table.grid_[i] = {pieces(model.patches[i].lengthU), pieces(model.patches[i].lengthV)};
    }
    tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t i) {
        parts[i] = cutPatch(model, std::uint32_t(i), table.grid_[i].columns, table.grid_[i].rows);
    });

    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    std::vector<Cell> cells;
    for (PatchCells& part : parts) {
        const auto shift = std::uint32_t(table.occluders_.size());
        for (std::size_t i = 0; i < part.cells.size(); ++i) {
            order.emplace_back(part.keys[i], std::uint32_t(cells.size()));
            cells.push_back(part.cells[i]);
            cells.back().firstOccluder += shift;
        }
        table.occluders_.insert(table.occluders_.end(), part.occluders.begin(), part.occluders.end());
        part = {};
    }
    std::ranges::sort(order);

    std::vector<double> cumulative{0};
    for (const auto& [key, index] : order) {
        const Cell& cell = table.cells_.emplace_back(cells[index]);
        const Patch& patch = model.patches[cell.patch];
        const double share = double(table.grid_[cell.patch].columns) * table.grid_[cell.patch].rows;
        cumulative.push_back(cumulative.back() + patch.area() * patch.density / share);
    }
    // Hidden cells have been left out, so that the rest lies a little closer than estimated.
    table.spacing_ = std::sqrt(cumulative.back() / double(points));
    table.first_.reserve(cumulative.size());
    for (const double sum : cumulative)
        table.first_.push_back(std::min(points, std::uint64_t(double(points) * (sum / cumulative.back()))));
    table.first_.back() = points;

    table.guide_.resize(table.cells_.size() + 1);
    std::uint32_t cell = 0;
    for (std::size_t slot = 0; slot < table.guide_.size(); ++slot) {
        const auto point = std::uint64_t(double(slot) / double(table.cells_.size()) * double(points));
        while (cell + 1 < table.cells_.size() && table.first_[cell + 1] <= point) ++cell;
        table.guide_[slot] = cell;
    }
    return table;
}

std::size_t CellTable::cellOf(std::uint64_t point) const {
    const auto slot = std::size_t(double(point) / double(points_) * double(cells_.size()));
    // The guess may be one slot off by rounding, hence the step back before walking on.
    std::size_t cell = guide_[std::min(slot, guide_.size() - 1)];
    while (cell > 0 && first_[cell] > point) --cell;
    while (cell + 1 < cells_.size() && first_[cell + 1] <= point) ++cell;
    return cell;
}

}  // namespace scancast
