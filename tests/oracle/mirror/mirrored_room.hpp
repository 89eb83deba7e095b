// A room that is known point by point, with a mirror on its north wall, and the same room with its mirror
// image as points behind the wall: what a mirror shows must look like that.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast::test {

/// The same point in the mirror.
inline AnalyticPoint imageOf(AnalyticPoint p, const Mirror& mirror) {
    const glm::dvec3 n = mirror.normal;
    p.position -= n * (2 * glm::dot(p.position - mirror.center, n));
    const auto turn = [&](glm::vec3& v) { v -= glm::vec3(n * (2 * glm::dot(glm::dvec3(v), n))); };
    turn(p.surfel->normal);
    turn(p.surfel->majorAxis);
    return p;
}

/// 4 × 4 × 2.5 units around the z axis, moved and turned as a whole by `placed`.
class MirroredRoom {
  public:
    /// The mirror's wall leaves `gap` open around the glass, so that no splat of it reaches over the glass.
    MirroredRoom(double pointSpacing, double gap, const glm::dmat4& placed = glm::dmat4(1))
        : spacing(pointSpacing), roughness_(gap > 0 ? 0.004 : 0), placed_(placed) {
        mirror.center = at({0.2, 2, 1.3});
        mirror.normal = turned({0, -1, 0});
        mirror.up = turned({0, 0, 1});
        mirror.width = 1.6;
        mirror.height = 1.2;
        mirror.tint = {240, 250, 200};
        addWalls(gap);
        addBall({-0.6, 0.2, 0.9}, 0.3);
        addBall({1.2, -0.9, 1.4}, 0.4);
        addBall({0.55, 1.3, 1.35}, 0.15);  // hides some of the glass
        addRectangle({-1.6, -1.2, 0.7}, {1.5, 0, 0}, {0, 0.9, 0});
        putOnLattice();
    }

    glm::dvec3 at(const glm::dvec3& p) const { return glm::dvec3(placed_ * glm::dvec4(p, 1)); }
    glm::dvec3 turned(const glm::dvec3& v) const { return glm::dvec3(placed_ * glm::dvec4(v, 0)); }

    /// What stands before the mirror, seen in it: all of it.
    std::vector<AnalyticPoint> images() const {
        std::vector<AnalyticPoint> images;
        for (const AnalyticPoint& p : points) images.push_back(imageOf(p, mirror));
        return images;
    }

    const double spacing;
    std::vector<AnalyticPoint> points;
    Mirror mirror;

    void add(const glm::dvec3& position, const glm::dvec3& normal) {
        AnalyticPoint p;
        p.position = at(position + normal * numbers_.uniform(0, roughness_));
        const auto wave = [&](double f, double g) {
            const double v = std::sin(position.x * f) * std::cos(position.y * g + position.z * f);
            return static_cast<std::uint8_t>(128 + 100 * v + numbers_.uniform(-20, 20));
        };
        p.rgb = {wave(7, 5), wave(4, 9), wave(11, 3)};
        Surfel s;
        s.normal = glm::vec3(turned(normal));
        const glm::dvec3 across =
            std::abs(normal.z) > 0.5 ? glm::dvec3(1, 0, 0) : glm::normalize(glm::cross(normal, {0, 0, 1}));
        s.majorAxis = glm::vec3(turned(glm::normalize(across - normal * glm::dot(across, normal))));
        s.radius = static_cast<float>(1.2 * spacing);
        s.major = static_cast<float>(1.6 * spacing);
        s.minor = 0.8f * s.major;
        p.surfel = s;
        points.push_back(p);
    }

  private:
    /// Moves all points to where a cloud's samples say they are, and makes so many of them that their mirror
    /// image splits into the leaves' images: then the images' samples say exactly the same, reflected.
    void putOnLattice() {
        points.resize(points.size() / 256 * 256);
        for (std::size_t i = 0; i < points.size(); ++i) {
            points[i].intensity = static_cast<std::uint16_t>(i & 65535);
            points[i].classification = static_cast<std::uint8_t>(i >> 16);
        }
        const AnalyticCloud cloud(points, spacing);
        for (const CutRun& run : cloud.cut().runs)
            for (const Sample& s : run.samples)
                points[s.intensity | std::size_t(s.classification) << 16].position =
                    run.node->boxMin + run.node->step * glm::dvec3(s.x, s.y, s.z);
    }

    void addRectangle(const glm::dvec3& corner, const glm::dvec3& a, const glm::dvec3& b) {
        const glm::dvec3 normal = glm::normalize(glm::cross(a, b));
        const int m = static_cast<int>(glm::length(a) / spacing),
                  n = static_cast<int>(glm::length(b) / spacing);
        for (int i = 0; i < m; ++i)
            for (int j = 0; j < n; ++j)
                add(corner + a * ((i + numbers_.uniform(0.2, 0.8)) / m) +
                        b * ((j + numbers_.uniform(0.2, 0.8)) / n),
                    normal);
    }

    void addBall(const glm::dvec3& center, double radius) {
        const int count = static_cast<int>(4 * 3.14159 * radius * radius / (spacing * spacing));
        for (int i = 0; i < count; ++i) {
            const double z = 1 - 2 * (i + 0.5) / count, turn = i * 2.399963229728653;
            const double r = std::sqrt(1 - z * z);
            const glm::dvec3 n(r * std::cos(turn), r * std::sin(turn), z);
            add(center + n * radius, n);
        }
    }

    void addWalls(double gap) {
        addRectangle({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
        addRectangle({-2, -2, 2.5}, {0, 4, 0}, {4, 0, 0});
        addRectangle({-2, -2, 0}, {0, 0, 2.5}, {4, 0, 0});
        addRectangle({-2, -2, 0}, {0, 4, 0}, {0, 0, 2.5});
        addRectangle({2, -2, 0}, {0, 0, 2.5}, {0, 4, 0});
        const double left = -0.6 - gap, right = 1 + gap, low = 0.7 - gap, high = 1.9 + gap;
        addRectangle({-2, 2, 0}, {4, 0, 0}, {0, 0, low});
        addRectangle({-2, 2, high}, {4, 0, 0}, {0, 0, 2.5 - high});
        addRectangle({-2, 2, low}, {left + 2, 0, 0}, {0, 0, high - low});
        addRectangle({right, 2, low}, {2 - right, 0, 0}, {0, 0, high - low});
    }

    /// Discs need the roughness of a scan: on an exact plane, rounding alone says which of two is nearer. But
    /// what of an abutting wall stands out before the glass is the glass's.
    double roughness_;
    glm::dmat4 placed_;
    Numbers numbers_{11};
};

}  // namespace scancast::test
