#include "simulator/sampler.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/lighting.hpp"

namespace scancast {
namespace {

double fraction(double x) {
    return x - std::floor(x);
}

std::uint8_t toByte(float x) {
    return std::uint8_t(std::clamp(x * 255 + 0.5F, 0.0F, 255.0F));
}

constexpr double lineRange = 15;  ///< the distance at which scan lines are one spacing apart

}  // namespace

/// Points of a cell lie on a golden-ratio lattice, shifted and shaken: even cover without the look of a grid.
SurfacePoint Sampler::surfacePoint(std::size_t cellIndex, std::uint64_t index, PointRandom& random) const {
    const Cell& cell = cells_.cell(cellIndex);
    const Patch& patch = model_.patches[cell.patch];
    if (patch.regular) return regularPoint(cell, cellIndex, index, random);
    const std::uint64_t first = cells_.firstPoint(cellIndex), number = index - first;
    const auto count = double(cells_.firstPoint(cellIndex + 1) - first);
    const double columns = cells_.columns(cell.patch), rows = cells_.rows(cell.patch);
    const std::uint64_t shift = mixBits(seed_, ~std::uint64_t(cellIndex));
    const double shake = 0.45 / std::sqrt(count);
    double a = fraction((double(number) + 0.5) / count + unitDouble(shift) + shake * (random.unit() - 0.5));
    double b = fraction(double(number) * 0.6180339887498949 + unitDouble(mixBits(shift)) +
                        shake * (random.unit() - 0.5));
    if (patch.lengthU / columns < patch.lengthV / rows) std::swap(a, b);
    SurfacePoint point = patch.at((cell.column + a) / columns, (cell.row + b) / rows);
    point.random = &random;
    return point;
}

/// Rows of equally spaced points, each shaken within its square.
SurfacePoint Sampler::regularPoint(const Cell& cell, std::size_t cellIndex, std::uint64_t index,
                                   PointRandom& random) const {
    const Patch& patch = model_.patches[cell.patch];
    const std::uint64_t first = cells_.firstPoint(cellIndex),
                        count = cells_.firstPoint(cellIndex + 1) - first, number = index - first;
    const auto wanted = std::uint64_t(std::round(std::sqrt(double(count) * patch.lengthV / patch.lengthU)));
    const std::uint64_t rows = std::clamp<std::uint64_t>(wanted, 1, count);
    // Row r holds the points from r·count/rows on, so that the rows share all points as evenly as can be.
    const auto beginOf = [&](std::uint64_t r) { return r * count / rows; };
    std::uint64_t row = std::min(rows - 1, number * rows / count);
    while (row > 0 && beginOf(row) > number) --row;
    while (row + 1 < rows && beginOf(row + 1) <= number) ++row;
    const std::uint64_t begin = beginOf(row), end = beginOf(row + 1);
    constexpr float shake = 0.4F;
    const auto shaken = [&](std::uint64_t place) {
        return double(place) + 0.5 + shake * (random.unit() - 0.5F);
    };
    const double a = shaken(number - begin) / double(end - begin);
    SurfacePoint point = patch.at(a, shaken(row) / double(rows));
    point.random = &random;
    return point;
}

/// What the instrument adds: noise along the beam, return strength by material, angle and range, grain in the
/// colours.
void Sampler::record(const Cell& cell, const glm::dvec3& seen, float facing, const SurfacePoint& surface,
                     PointRandom& random, ScanPoint& out) const {
    const glm::dvec3& station = model_.stations[cell.station];
    const glm::dvec3 way = seen - station;
    const double range = std::max(1e-6, glm::length(way));
    out.position = seen + way * (noise_ * model_.rangeNoise * random.bell() / range);
    const double steps = lineRange * 6.283185307179586 / cells_.spacing();
    const BeamAngles beam = beamAngles(way);
    const auto line = std::uint64_t(std::min(beam.azimuth * steps, 16777215.0));
    out.beam = (std::uint64_t(cell.station) << 48) | (line << 24) | std::uint64_t(beam.elevation * 16777215);

    const float grazing = std::clamp(facing / float(range), 0.0F, 1.0F);
    const float strength = surface.reflectance * (0.3F + 0.7F * std::sqrt(grazing)) /
                           (1 + float(range) / 120) * float(1 + 0.04 * random.bell());
    out.intensity = std::uint16_t(std::clamp(strength * 52000, 0.0F, 65535.0F));
}

ScanPoint Sampler::point(std::uint64_t index) const {
    PointRandom random(seed_, index);
    const std::size_t cellIndex = cells_.cellOf(index);
    const Cell& cell = cells_.cell(cellIndex);
    const Patch& patch = model_.patches[cell.patch];
    SurfacePoint surface = surfacePoint(cellIndex, index, random);
    patch.material->apply(patch, surface);
    glm::vec3 color = lit(model_, cells_, &cell, patch, surface);

    ScanPoint out;
    glm::dvec3 seen = surface.position, normal = surface.normal;
    if (patch.mirror >= 0) {
        const Mirror& mirror = model_.mirrors[std::size_t(patch.mirror)];
        seen = reflected(mirror, seen);
        normal -= mirror.normal * (2 * glm::dot(normal, mirror.normal));
        for (int c = 0; c < 3; ++c) color[c] *= float(mirror.tint[std::size_t(c)]) / 255;
        surface.reflectance *= 0.8F;
    }
    const auto facing = float(std::abs(glm::dot(model_.stations[cell.station] - seen, normal)));
    record(cell, seen, facing, surface, random, out);
    const auto grain = float(1 + noise_ * model_.colorNoise * random.bell());
    out.color = {toByte(color.x * grain), toByte(color.y * grain), toByte(color.z * grain)};
    out.normal = patch.hasNormal ? glm::vec3(normal) : glm::vec3(0);
    out.classification = surface.classification;
    return out;
}

}  // namespace scancast
