#include "renderer/look/surveyed_scene.hpp"

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "renderer/cloud/import/crs_text.hpp"

namespace scancast {

namespace {

/// |n · up| above which a surface counts as level, and below which as upright.
constexpr double levelNormal = 0.9, uprightNormal = 0.3;

// ---------------------------------------------------------------------------------------------------------
// Seen by one camera
// ---------------------------------------------------------------------------------------------------------

/// Depth cameras see some metres far, and write metres; a landscape with coordinates of its own lies higher.
constexpr double farthestDepth = 25;

/// The points as that camera saw them: x / z, y / z, and depth.
struct Seen {
    std::vector<glm::dvec2> at;
    std::vector<double> depth;
    std::array<double, 2> left, right;
};

/// A depth camera looks along +z, or along -z as in computer graphics; `sign` says which.
std::optional<Seen> seenFrom(const glm::dvec3& eye, const std::vector<SurveyPoint>& points, double sign) {
    Seen seen;
    std::vector<double> xs, ys;
    for (const SurveyPoint& p : points) {
        const glm::dvec3 to = p.position - eye;
        const double depth = sign * to.z;
        if (!(depth > 0)) return std::nullopt;
        seen.at.emplace_back(to.x / depth, to.y / depth);
        seen.depth.push_back(depth);
        xs.push_back(seen.at.back().x);
        ys.push_back(seen.at.back().y);
    }
    seen.left = {quantileOf(xs, 0.01), quantileOf(ys, 0.01)};
    seen.right = {quantileOf(xs, 0.99), quantileOf(ys, 0.99)};
    return seen;
}

/// How much of the camera's picture is filled, and in how much of that each line of sight ends at one depth.
struct Frame2d {
    double filled = 0, single = 0;
};

Frame2d asPicture(const Seen& seen) {
    constexpr int columns = 48, rows = 36;
    struct Pixel {
        double nearest = INFINITY, farthest = 0;
    };
    std::map<int, Pixel> pixels;
    for (std::size_t i = 0; i < seen.at.size(); ++i) {
        const double u = (seen.at[i].x - seen.left[0]) / (seen.right[0] - seen.left[0]);
        const double v = (seen.at[i].y - seen.left[1]) / (seen.right[1] - seen.left[1]);
        if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) continue;
        Pixel& pixel = pixels[int(v * rows) * columns + int(u * columns)];
        pixel.nearest = std::min(pixel.nearest, seen.depth[i]);
        pixel.farthest = std::max(pixel.farthest, seen.depth[i]);
    }
    Frame2d frame;
    frame.filled = double(pixels.size()) / (columns * rows);
    for (const auto& [place, pixel] : pixels)
        if (pixel.farthest < 1.15 * pixel.nearest) frame.single += 1.0 / double(pixels.size());
    return frame;
}

/// Whether the scan looks like one frame of a camera: in front of it, around its axis, and in nearly every
/// direction at one depth only.
bool isDepthFrame(const Seen& seen) {
    const double width = seen.right[0] - seen.left[0], height = seen.right[1] - seen.left[1];
    if (!(width > 0.05 && height > 0.05 && width < 3 && height < 3)) return false;
    for (int a = 0; a < 2; ++a) {
        const double size = seen.right[std::size_t(a)] - seen.left[std::size_t(a)];
        if (seen.left[std::size_t(a)] > 0.75 * size || seen.right[std::size_t(a)] < -0.75 * size)
            return false;
    }
    const Frame2d frame = asPicture(seen);
    return frame.filled > 0.35 && frame.single > 0.7;
}

/// The camera stood where the scan says, or at the origin.
std::optional<SurveyedScene> asDepthFrame(const std::vector<SurveyPoint>& points,
                                          const std::optional<glm::dvec3>& place) {
    const glm::dvec3 eye = place.value_or(glm::dvec3(0));
    for (const double sign : {1.0, -1.0}) {
        const auto seen = seenFrom(eye, points, sign);
        if (!seen || quantileOf(seen->depth, 0.99) > farthestDepth || !isDepthFrame(*seen)) continue;
        SurveyedScene scene;
        scene.kind = SceneKind::DepthFrame;
        // Cameras count rows downwards; who looks along -z follows computer graphics, where y points up.
        scene.up = {0, -sign, 0};
        scene.forward = {0, 0, sign};
        scene.sensor = eye;
        scene.reason = fmt::format(
            "Everything lies in front of {}, along {}z, and each line of sight from there ends at one depth: "
            "what "
            "a camera saw that stood there. ",
            place ? "the sensor" : "the origin", sign > 0 ? '+' : '-');
        return scene;
    }
    return std::nullopt;
}

// ---------------------------------------------------------------------------------------------------------
// Which way is up
// ---------------------------------------------------------------------------------------------------------

/// Formats of surveying, in which z is up by definition; and far from the origin coordinates are a map's.
bool isSurvey(const CloudFacts& facts) {
    for (const std::string_view format : {"LAS", "LAZ", "COPC", "PTX", "PTS", "E57", "EPT", "Potree"})
        if (facts.format.starts_with(format)) return true;
    const glm::dvec3 size = facts.bounds[1] - facts.bounds[0];
    const double farthest = std::max(std::abs(facts.bounds[0].x), std::abs(facts.bounds[0].y));
    return !facts.crsWkt.empty() || facts.crsEpsg || farthest > 20 * std::max({size.x, size.y, size.z});
}

/// Models, unlike surveys, are mostly made with Y up, and set down on the plane y = 0 around the origin.
bool standsOnXZ(const std::array<glm::dvec3, 2>& box) {
    const glm::dvec3 size = box[1] - box[0];
    const auto standsOn = [&](int axis) { return std::abs(box[0][axis]) <= 0.02 * size[axis]; };
    const auto straddles = [&](int axis) { return box[0][axis] < 0 && box[1][axis] > 0; };
    return standsOn(1) && !standsOn(2) && straddles(0) && straddles(2);
}

/// Share of the box's cross-section that the lowest (or highest) twentieth of the scan reaches over.
double breadth(const std::vector<SurveyPoint>& points, const std::array<glm::dvec3, 2>& box, int axis,
               bool lowest) {
    const glm::dvec3 size = box[1] - box[0];
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    std::vector<double> first, second;
    for (const SurveyPoint& p : points) {
        const double height = (p.position[axis] - box[0][axis]) / size[axis];
        if (lowest ? height > 0.05 : height < 0.95) continue;
        first.push_back(p.position[a]);
        second.push_back(p.position[b]);
    }
    if (first.size() < 8) return 0;
    const double wide = quantileOf(first, 0.95) - quantileOf(first, 0.05);
    const double deep = quantileOf(second, 0.95) - quantileOf(second, 0.05);
    return wide * deep / (size[a] * size[b]);
}

/// Share of the normals that are level with regard to the axis; 0 without normals.
double levelShare(const std::vector<SurveyPoint>& points, int axis) {
    double level = 0, all = 0;
    for (const SurveyPoint& p : points) {
        if (p.normal == glm::vec3(0)) continue;
        ++all;
        if (std::abs(p.normal[axis]) > levelNormal) ++level;
    }
    return all > 0 ? level / all : 0;
}

/// Things stand on their broad side, and floors are larger than any one wall.
void decideUp(const CloudFacts& facts, SurveyedScene& scene) {
    if (isSurvey(facts)) {
        scene.up = {0, 0, 1};
        scene.reason += "Z is up, as in all surveys. ";
        return;
    }
    const glm::dvec3 size = scene.size();
    double best = -INFINITY;
    for (const int axis : {2, 1}) {
        for (const double sign : {1.0, -1.0}) {
            if (axis == 2 && sign < 0) continue;  // nobody has z down but depth cameras
            double score = 0;
            if (size[axis] > 0)
                score = breadth(scene.points, scene.box, axis, sign > 0) -
                        breadth(scene.points, scene.box, axis, sign < 0);
            score += 1.5 * levelShare(scene.points, axis);
            if (axis == 2) score += 0.1;
            if (axis == 1 && sign > 0) score += standsOnXZ(scene.box) ? 1 : 0.05;
            if (axis == 1 && sign < 0) score -= 0.25;
            if (score <= best) continue;
            best = score;
            scene.up = glm::dvec3(0);
            scene.up[axis] = sign;
        }
    }
    scene.reason +=
        fmt::format("{} is up: that is how the scan stands most broadly. ", scene.up.z != 0  ? "Z"
                                                                            : scene.up.y > 0 ? "Y"
                                                                                             : "-Y");
}

// ---------------------------------------------------------------------------------------------------------
// What kind of scene
// ---------------------------------------------------------------------------------------------------------

/// The scan as a map: columns of a grid over the ground.
struct Map {
    static constexpr int side = 32;
    struct Column {
        int points = 0, low = 0, high = 0;  ///< in all, near the floor of the whole, near its top
    };
    std::array<Column, side * side> columns{};
    double filled = 0, floor = 0, ceiling = 0, inner = 0;  ///< shares
};

Map mapOf(const SurveyedScene& scene, const std::array<glm::dvec3, 2>& axes) {
    const auto along = [&](const glm::dvec3& axis) {
        std::vector<double> values;
        for (const SurveyPoint& p : scene.points) values.push_back(glm::dot(p.position, axis));
        return std::array{quantileOf(values, 0.005), quantileOf(values, 0.995)};
    };
    const auto x = along(axes[0]), y = along(axes[1]), z = along(scene.up);
    Map map;
    const auto share = [](double value, const std::array<double, 2>& range) {
        return (value - range[0]) / std::max(range[1] - range[0], 1e-12);
    };
    double inner = 0;
    for (const SurveyPoint& p : scene.points) {
        const double u = share(glm::dot(p.position, axes[0]), x), v = share(glm::dot(p.position, axes[1]), y);
        const double w = share(glm::dot(p.position, scene.up), z);
        if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) continue;
        auto& column = map.columns[std::size_t(int(v * Map::side) * Map::side + int(u * Map::side))];
        ++column.points;
        column.low += w < 0.12;
        column.high += w > 0.88;
        const double edge = std::min({u, 1 - u, v, 1 - v, w, 1 - w});
        inner += edge > 0.1;
    }
    for (const auto& column : map.columns) {
        if (column.points == 0) continue;
        map.filled += 1;
        map.floor += column.low > 0;
        map.ceiling += column.high > 0;
    }
    map.floor /= map.filled;
    map.ceiling /= map.filled;
    map.filled /= Map::side * Map::side;
    map.inner = inner / double(scene.points.size());
    return map;
}

/// Shares of the surface that stand upright and that are level; nullopt without normals.
struct Slopes {
    double upright = 0, level = 0;
};

std::optional<Slopes> slopesOf(const SurveyedScene& scene) {
    Slopes slopes;
    double all = 0;
    for (const SurveyPoint& p : scene.points) {
        if (p.normal == glm::vec3(0)) continue;
        const double slope = std::abs(glm::dot(glm::dvec3(p.normal), scene.up));
        ++all;
        slopes.upright += slope < uprightNormal;
        slopes.level += slope > levelNormal;
    }
    if (all == 0) return std::nullopt;
    return Slopes{slopes.upright / all, slopes.level / all};
}

/// Built things are level or upright; where nobody knows, they may be.
bool isBuilt(const std::optional<Slopes>& slopes) {
    return !slopes || slopes->upright + slopes->level > 0.6;
}

bool hasClassesOfLand(const CloudFacts& facts) {
    return facts.attributes.classification && facts.classCounts[2] > 0;
}

/// Degrees on the ground and metres above it: seen from the side that is a needle.
bool isInDegrees(const CloudFacts& facts) {
    return crsUnit(facts.crsWkt, facts.crsEpsg) == "degree";
}

void decideKind(const CloudFacts& facts, SurveyedScene& scene) {
    if (isInDegrees(facts)) {
        scene.kind = SceneKind::Airborne;
        scene.onlyFromAbove = true;
        scene.reason += "Its coordinates are degrees, its heights are not: a map, seen from above. ";
        return;
    }
    const auto axes = horizontalAxes(scene.up);
    const Map map = mapOf(scene, axes);
    const glm::dvec3 size = scene.size();
    const double height = std::abs(glm::dot(size, scene.up));
    const double width = std::max(std::abs(glm::dot(size, axes[0])), std::abs(glm::dot(size, axes[1])));
    const double tall = height / std::max(width, 1e-12);
    const auto slopes = slopesOf(scene);
    const double upright = slopes ? slopes->upright : 0;
    const bool survey = isSurvey(facts);
    const std::string measured = fmt::format(
        "(height {:.0f} % of the width, {:.0f} % of the map filled, {:.0f} % of the surface upright)",
        100 * tall, 100 * map.filled, 100 * upright);
    if (!scene.sensor && map.floor > 0.6 && map.ceiling > 0.5 && map.inner > 0.08 && tall > 0.05 &&
        tall < 1.2 && isBuilt(slopes)) {
        scene.kind = SceneKind::Indoor;
        scene.reason += "A floor below and a ceiling above nearly everywhere: rooms " + measured + ". ";
    } else if (survey && tall < 0.5 && map.filled > 0.55 && (upright < 0.45 || hasClassesOfLand(facts)) &&
               !scene.sensor) {
        scene.kind = SceneKind::Airborne;
        scene.reason += "Broad, low and seen from above: a landscape " + measured + ". ";
    } else if (scene.sensor || (tall < 0.35 && map.floor > 0.5 && isBuilt(slopes))) {
        scene.kind = SceneKind::Street;
        scene.reason +=
            "A ground with upright things on it, with gaps: scanned from the ground " + measured + ". ";
    } else {
        scene.kind = SceneKind::Object;
        scene.reason += "As high as it is wide, or without a ground: an object " + measured + ". ";
    }
}

}  // namespace

double SurveyedScene::extent() const {
    return std::max(glm::length(size()), 1e-9 * std::max(glm::length(center()), 1.0));
}

std::array<glm::dvec3, 2> horizontalAxes(const glm::dvec3& up) {
    const glm::dvec3 first = glm::normalize(std::abs(up.x) < 0.9 ? glm::dvec3(1, 0, 0) - up * up.x
                                                                 : glm::dvec3(0, 1, 0) - up * up.y);
    return {first, glm::cross(up, first)};
}

SurveyedScene sceneOf(const CloudFacts& facts, std::vector<SurveyPoint> points) {
    points = withoutStrays(std::move(points));
    if (!isSurvey(facts))
        if (auto frame = asDepthFrame(points, facts.scanner)) {
            frame->box = boxOf(points);
            frame->points = std::move(points);
            return *frame;
        }
    SurveyedScene scene;
    scene.box = boxOf(points);
    scene.points = std::move(points);
    scene.sensor = facts.scanner;
    decideUp(facts, scene);
    decideKind(facts, scene);
    return scene;
}

}  // namespace scancast
