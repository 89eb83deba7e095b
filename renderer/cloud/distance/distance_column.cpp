#include "renderer/cloud/distance/distance_column.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/cloud/build/histogram_parts.hpp"

namespace scancast {

void DistanceSummary::add(std::span<const float> distances) {
    for (const float distance : distances) {
        range_[0] = std::min(range_[0], double(distance));
        range_[1] = std::max(range_[1], double(distance));
        beyond_ += distance >= most_;
        sketch_.add(double(distance));
    }
}

void DistanceSummary::tell(KeptColumn& column) const {
    column.range = range_;
    column.usual = sketch_.usual();
    column.histogram = sketch_.histogram(histogramParts(range_, *column.usual, 0));
}

Column distanceColumn(const DistanceOptions& options, const CloudFacts& before, const std::string& unit) {
    Column column{.name = options.name, .type = ColumnType::Float32, .description = {}};
    column.description = "distance to the nearest point of " + before.title;
    // Epochs of a place are often called the same.
    if (!before.recorded.empty()) column.description += " of " + before.recorded;
    if (options.shift != glm::dvec3(0))
        column.description +=
            fmt::format(", shifted by {}, {}, {}", options.shift.x, options.shift.y, options.shift.z);
    if (!unit.empty()) column.description += ", " + unit;
    column.description += fmt::format("; {} is that or more", options.most);
    return column;
}

}  // namespace scancast
