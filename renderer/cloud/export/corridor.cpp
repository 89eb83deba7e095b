#include "renderer/cloud/export/corridor.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "protocol/points/points_request.hpp"

namespace scancast {

Expected<Corridor> Corridor::create(const std::vector<glm::dvec2>& line, double width) {
    if (auto ok = checkLine(line, width); !ok) return passOn(ok);
    Corridor made;
    made.half_ = width / 2;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const glm::dvec2 way = line[i + 1] - line[i];
        const double length = std::hypot(way.x, way.y);
        made.segments_.push_back({line[i], line[i + 1], way / length, length, made.length_});
        made.length_ += length;
    }
    made.all_.resize(made.segments_.size());
    std::iota(made.all_.begin(), made.all_.end(), 0U);
    return made;
}

std::optional<CorridorPlace> Corridor::place(const glm::dvec2& p,
                                             std::span<const std::uint32_t> segments) const {
    double nearest = std::numeric_limits<double>::infinity();
    CorridorPlace place;
    bool isBeyond = false;
    for (const std::uint32_t index : segments) {
        const Segment& s = segments_[index];
        const glm::dvec2 away = p - s.from;
        const double along = glm::dot(away, s.along);
        const double right = s.along.y * away.x - s.along.x * away.y;
        double squared = right * right;
        if (along < 0) squared = glm::dot(away, away);
        if (along > s.length) squared = glm::dot(p - s.to, p - s.to);
        if (!(squared < nearest)) continue;
        nearest = squared;
        place.station = s.station + std::clamp(along, 0.0, s.length);
        place.offset = along < 0 || along > s.length ? std::copysign(std::sqrt(squared), right) : right;
        isBeyond = (index == 0 && along < 0) || (index + 1 == segments_.size() && along > s.length);
    }
    if (isBeyond || !(std::abs(place.offset) <= half_) || segments.empty()) return std::nullopt;
    return place;
}

std::vector<std::uint32_t> Corridor::segmentsNear(const glm::dvec2& low, const glm::dvec2& high) const {
    const glm::dvec2 center = (low + high) * 0.5, reach = (high - low) * 0.5;
    // Doubles at coordinates of a country are good for nanometres.
    const double margin = 1e-9 * (std::abs(center.x) + std::abs(center.y) + half_);
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < segments_.size(); ++i) {
        const Segment& s = segments_[i];
        // Apart on an axis of the rectangle, or across or along the segment.
        const glm::dvec2 least = glm::min(s.from, s.to) - half_ - margin;
        const glm::dvec2 most = glm::max(s.from, s.to) + half_ + margin;
        if (low.x > most.x || high.x < least.x || low.y > most.y || high.y < least.y) continue;
        const glm::dvec2 away = center - s.from;
        const double right = s.along.y * away.x - s.along.x * away.y, along = glm::dot(away, s.along);
        const double across = std::abs(s.along.y) * reach.x + std::abs(s.along.x) * reach.y;
        const double ahead = std::abs(s.along.x) * reach.x + std::abs(s.along.y) * reach.y;
        if (std::abs(right) - across > half_ + margin) continue;
        if (along + ahead < -half_ - margin || along - ahead > s.length + half_ + margin) continue;
        near.push_back(i);
    }
    return near;
}

}  // namespace scancast
