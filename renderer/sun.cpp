#include "renderer/sun.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <vector>

namespace scancast {
namespace {

using Corners = std::vector<glm::dvec3>;

/// What of a convex polygon lies where dot(plane, corner) ≥ 0.
Corners insideOf(const Corners& polygon, const glm::dvec4& plane) {
    const auto side = [&](const glm::dvec3& p) { return glm::dot(glm::dvec3(plane), p) + plane.w; };
    Corners out;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const double a = side(from), b = side(to);
        if (a >= 0) out.push_back(from);
        if ((a >= 0) != (b >= 0)) out.push_back(from + (to - from) * (a / (a - b)));
    }
    return out;
}

/// The corners of the box that the planes leave: those of its sides, and the frustum's own where they lie inside.
Corners shownOf(const std::array<glm::dvec3, 2>& box, const Viewpoint& picture) {
    Corners shown;
    const auto planes = picture.frustum();
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const glm::dvec3& end : box) {
            Corners side(4, end);
            for (std::size_t i = 0; i < 4; ++i) {
                side[i][u] = box[i == 1 || i == 2 ? 1 : 0][u];
                side[i][v] = box[i >= 2 ? 1 : 0][v];
            }
            for (const glm::dvec4& plane : planes) side = insideOf(side, plane);
            shown.insert(shown.end(), side.begin(), side.end());
        }
    }
    const glm::dmat4 toCloud = glm::inverse(picture.cloudToView);
    const double unit = picture.projection == Projection::Perspective ? picture.near / picture.pixelsPerUnit
                                                                      : 1 / picture.pixelsPerUnit;
    for (const double x : {-0.5, 0.5}) {
        for (const double y : {-0.5, 0.5}) {
            const glm::dvec3 corner(
                toCloud * glm::dvec4(x * picture.width * unit, y * picture.height * unit, -picture.near, 1));
            const bool isInside = glm::all(glm::greaterThanEqual(corner, box[0])) &&
                                  glm::all(glm::lessThanEqual(corner, box[1]));
            if (isInside) shown.push_back(corner);
        }
    }
    return shown;
}

/// Least and greatest of a direction.
struct Interval {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    double size() const { return high - low; }
};

}  // namespace

std::optional<Viewpoint> sunViewpoint(const std::array<glm::dvec3, 2>& bounds, const Viewpoint& picture,
                                      const glm::dvec3& wayToSun) {
    const Corners shown = shownOf(bounds, picture);
    if (shown.empty()) return std::nullopt;
    const glm::dvec3 back = glm::normalize(wayToSun);
    const glm::dvec3 aside = std::abs(back.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(aside, back)), up = glm::cross(back, right);
    Interval x, y, z;
    for (const glm::dvec3& p : shown) {
        x.add(glm::dot(right, p));
        y.add(glm::dot(up, p));
    }
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p(bounds[corner & 1].x, bounds[corner >> 1 & 1].y, bounds[corner >> 2].z);
        z.add(glm::dot(back, p));
    }
    // Pixels of few sizes, whole numbers of them from the cloud's origin. Some more around: shadows are looked up softly.
    constexpr int around = 8;
    const int largest =
        std::clamp(2 * std::max(picture.width, picture.height), smallestShadowMap, largestShadowMap);
    const double least = std::max({x.size(), y.size(), z.size() * 1e-6, 1e-9}) / (largest - 2 * around);
    const double pixel = std::exp2(std::ceil(std::log2(least) * 4) / 4);
    const double left = std::floor(x.low / pixel) - around, lower = std::floor(y.low / pixel) - around;
    Viewpoint sun;
    sun.projection = Projection::Orthographic;
    sun.width = std::min(largest, static_cast<int>(std::ceil(x.high / pixel) - left) + around);
    sun.height = std::min(largest, static_cast<int>(std::ceil(y.high / pixel) - lower) + around);
    sun.pixelsPerUnit = 1 / pixel;
    const glm::dvec3 middle((left + sun.width * 0.5) * pixel, (lower + sun.height * 0.5) * pixel,
                            z.high + z.size() + pixel);
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, up, back));
    sun.cloudToView = glm::dmat4(rotation);
    sun.cloudToView[3] = glm::dvec4(-middle, 1);
    sun.near = pixel;
    sun.far = std::numeric_limits<double>::infinity();
    return sun;
}

}  // namespace scancast
