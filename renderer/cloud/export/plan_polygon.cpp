#include "renderer/cloud/export/plan_polygon.hpp"

#include <algorithm>
#include <glm/common.hpp>

namespace scancast {
namespace {

constexpr std::size_t mostBands = 512;

/// Whether a segment touches a rectangle, by cutting it down to the rectangle's slabs (Liang and Barsky).
bool touches(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& low, const glm::dvec2& high) {
    double from = 0, to = 1;
    for (int axis = 0; axis < 2; ++axis) {
        const double along = b[axis] - a[axis];
        if (along == 0) {
            if (a[axis] < low[axis] || a[axis] > high[axis]) return false;
            continue;
        }
        double enters = (low[axis] - a[axis]) / along, leaves = (high[axis] - a[axis]) / along;
        if (enters > leaves) std::swap(enters, leaves);
        from = std::max(from, enters);
        to = std::min(to, leaves);
    }
    return from <= to;
}

}  // namespace

PolygonTest::PolygonTest(const PlanPolygon& polygon) {
    low_ = high_ = polygon.front();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        low_ = glm::min(low_, a);
        high_ = glm::max(high_, a);
        if (a.y > b.y) std::swap(a, b);
        edges_.push_back({a, b, a.y < b.y ? (b.x - a.x) / (b.y - a.y) : 0});
    }
    bands_.resize(std::clamp(polygon.size(), std::size_t(1), mostBands));
    const double height = high_.y - low_.y;
    bandsPerUnit_ = height > 0 ? double(bands_.size()) / height : 0;
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
        const std::size_t last = bandOf(edges_[e].high.y);
        for (std::size_t band = bandOf(edges_[e].low.y); band <= last; ++band) bands_[band].push_back(e);
    }
    for (const auto& band : bands_) entriesBefore_.push_back(entriesBefore_.back() + band.size());
}

// The same monotone function of y for edges and for points: what an edge reaches, its bands do.
std::size_t PolygonTest::bandOf(double y) const {
    const double band = (y - low_.y) * bandsPerUnit_, last = double(bands_.size() - 1);
    if (!(band > 0)) return 0;  // no number either: heights that are out of all proportion
    return band < last ? std::size_t(band) : bands_.size() - 1;
}

bool PolygonTest::contains(const glm::dvec2& p) const {
    if (p.y < low_.y || p.y >= high_.y || p.x < low_.x || p.x > high_.x) return false;
    bool inside = false;
    for (const std::uint32_t e : bands_[bandOf(p.y)]) {
        const Edge& edge = edges_[e];
        if (p.y < edge.low.y || p.y >= edge.high.y) continue;
        if (p.x < edge.low.x + (p.y - edge.low.y) * edge.slope) inside = !inside;
    }
    return inside;
}

// Small ones are touched by few edges of few bands; large ones by some that stand in many.
bool PolygonTest::anyTouches(const glm::dvec2& low, const glm::dvec2& high) const {
    const auto touch = [&](const Edge& edge) { return touches(edge.low, edge.high, low, high); };
    const std::size_t first = bandOf(low.y), last = bandOf(high.y);
    if (entriesBefore_[last + 1] - entriesBefore_[first] >= edges_.size())
        return std::ranges::any_of(edges_, touch);
    for (std::size_t band = first; band <= last; ++band)
        if (std::ranges::any_of(bands_[band], [&](std::uint32_t e) { return touch(edges_[e]); })) return true;
    return false;
}

Within PolygonTest::of(const glm::dvec2& low, const glm::dvec2& high) const {
    if (low.x > high_.x || high.x < low_.x || low.y > high_.y || high.y < low_.y) return Within::Outside;
    if (anyTouches(low, high)) return Within::Across;
    return contains((low + high) * 0.5) ? Within::Inside : Within::Outside;
}

}  // namespace scancast
