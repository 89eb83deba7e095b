// Surfaces that tests sample into surfels themselves, and what they measure in pictures of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "renderer/cloud/surfels/surfels.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/pictures/draw_surfels.hpp"

namespace scancast::test {

inline Rgb8 numbered(std::size_t i) {
    return {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8),
            static_cast<std::uint8_t>(i >> 16)};
}

inline std::size_t number(Rgb8 c) {
    return c[0] | std::size_t{c[1]} << 8 | std::size_t{c[2]} << 16;
}

/// Surfels as ingest estimates them, from the points alone.
inline void estimate(std::vector<AnalyticPoint>& points) {
    std::vector<glm::vec3> places;
    for (const AnalyticPoint& p : points) places.push_back(glm::vec3(p.position));
    std::vector<Surfel> surfels(points.size());
    estimateSurfels(places, {}, surfels);
    for (std::size_t i = 0; i < points.size(); ++i) points[i].surfel = surfels[i];
}

/// A jittered grid on the plane z = 0: |x| ≤ across, |y| ≤ along.
inline std::vector<AnalyticPoint> planeOf(double across, double along, double spacing,
                                          const std::function<Rgb8(double, double)>& color,
                                          double disorder = 1) {
    Numbers numbers(61);
    std::vector<AnalyticPoint> points;
    for (double x = -across; x <= across; x += spacing) {
        for (double y = -along; y <= along; y += spacing) {
            AnalyticPoint p;
            p.position = {x + disorder * spacing * numbers.uniform(-0.5, 0.5),
                          y + disorder * spacing * numbers.uniform(-0.5, 0.5), 0};
            p.rgb = color(p.position.x, p.position.y);
            points.push_back(p);
        }
    }
    return points;
}

/// Evenly spread with some disorder: a spiral of `count` points, shaken by half their spacing.
inline std::vector<AnalyticPoint> sphereOf(int count, double shaken = 0.4) {
    Numbers numbers(62);
    const double spacing = std::sqrt(4 * 3.14159265358979 / count);
    std::vector<AnalyticPoint> points;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - 2 * (i + 0.5) / count, angle = 2.399963229728653 * i;
        const double r = std::sqrt(1 - z * z);
        AnalyticPoint p;
        p.position = glm::normalize(glm::dvec3(r * std::cos(angle), r * std::sin(angle), z) +
                                    numbers.onSphere() * (shaken * spacing));
        p.rgb = numbered(points.size() + 1);
        p.surfel = surfelOf(p.position, 1.27 * spacing);
        points.push_back(p);
    }
    return points;
}

/// Points on the six faces of the cube [-1,1]³, each face in its own colour: 40 + 30 · face in red.
inline std::vector<AnalyticPoint> cubeOf(double spacing, double disorder = 0.6) {
    Numbers numbers(63);
    std::vector<AnalyticPoint> points;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        for (double u = -1 + spacing / 2; u < 1; u += spacing) {
            for (double v = -1 + spacing / 2; v < 1; v += spacing) {
                const auto shake = [&](double c) {
                    return std::clamp(c + disorder * spacing * numbers.uniform(-0.5, 0.5), -1.0, 1.0);
                };
                AnalyticPoint p;
                p.position[axis] = face % 2 ? 1 : -1;
                p.position[(axis + 1) % 3] = shake(u);
                p.position[(axis + 2) % 3] = shake(v);
                p.rgb = {std::uint8_t(40 + 30 * face), 100, 50};
                glm::dvec3 normal(0);
                normal[axis] = face % 2 ? 1 : -1;
                p.surfel = surfelOf(normal, 1.27 * spacing);
                points.push_back(p);
            }
        }
    }
    return points;
}

/// The ray through a pixel's centre, in cloud space.
struct Ray {
    glm::dvec3 origin, direction;
};

inline Ray rayThrough(const Viewpoint& view, double x, double y) {
    const glm::dmat4 back = glm::inverse(view.cloudToView);
    const double u = (x - view.width / 2.0) / view.pixelsPerUnit;
    const double v = (view.height / 2.0 - y) / view.pixelsPerUnit;
    const bool perspective = view.projection == Projection::Perspective;
    const glm::dvec4 origin = perspective ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(u, v, 0, 1);
    const glm::dvec4 direction = perspective ? glm::dvec4(u, v, -1, 0) : glm::dvec4(0, 0, -1, 0);
    return {glm::dvec3(back * origin), glm::normalize(glm::dvec3(back * direction))};
}

/// Where a ray enters the cube [-1,1]³, or leaves it if it starts inside: the face (as cubeOf counts them), or -1.
inline int faceHit(const Ray& ray) {
    double nearest = -1e300, farthest = 1e300;
    int face = -1, behind = -1;
    for (int a = 0; a < 3; ++a) {
        const double t0 = (-1 - ray.origin[a]) / ray.direction[a],
                     t1 = (1 - ray.origin[a]) / ray.direction[a];
        if (std::min(t0, t1) > nearest) {
            nearest = std::min(t0, t1);
            face = 2 * a + (ray.direction[a] > 0 ? 0 : 1);
        }
        if (std::max(t0, t1) < farthest) {
            farthest = std::max(t0, t1);
            behind = 2 * a + (ray.direction[a] > 0 ? 1 : 0);
        }
    }
    if (nearest > farthest) return -1;
    return nearest < 0 ? behind : face;
}

/// What a method lists, unlit, with everything that is not given at its default.
inline PassList methodPasses(const char* name, const ParameterValues& given) {
    const Method& method = *findMethod(name);
    return method.passes({method, resolveParameters(method, given).value()});
}

inline PassList discPasses(double scale = 1) {
    return methodPasses("disc", {{"scale", scale}});
}

inline PassList ewaPasses(double lowPass = 0.5) {
    return methodPasses("ewa", {{"lowPass", lowPass}});
}

inline PassList circularPasses(double lowPass = 0.5) {
    return methodPasses("ewa", {{"lowPass", lowPass}, {"shape", std::string("circle")}});
}

inline PassList voronoiPasses(bool smooth, bool silhouette = false) {
    return methodPasses("voronoi", {{"smooth", smooth}, {"silhouette", silhouette}});
}

inline Frame draw(Device& device, const Viewpoint& view, const AnalyticCloud& cloud, const PassList& passes,
                  bool oriented = false) {
    SurfelScene scene(view, cloud.cut(), passes);
    scene.drawing.oriented = oriented;
    return mustDraw(device, scene.drawing);
}

}  // namespace scancast::test
