#include "renderer/look/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

namespace scancast {

namespace {

using std::numbers::pi;

constexpr double aspect = 16.0 / 9;
constexpr double outsideFov = 45, insideFov = 75;
constexpr int headings = 8, insidePlaces = 5;

constexpr std::array<const char*, headings> compass{
    "from the south", "from the south-east", "from the east", "from the north-east",
    "from the north", "from the north-west", "from the west", "from the south-west"};
constexpr std::array<const char*, headings> sides{"front", "front right", "right", "back right",
                                                  "back",  "back left",   "left",  "front left"};

/// From the scene to the eye; heading 0 is south (-y), in models with Y up the side that +z points to.
glm::dvec3 direction(const glm::dvec3& up, int heading, double down) {
    const auto [east, north] = horizontalAxes(up);
    const double turn = heading * 2 * pi / headings;
    return std::cos(down) * (std::sin(turn) * east - std::cos(turn) * north) + std::sin(down) * up;
}

Camera cameraAlong(const SurveyedScene& scene, const glm::dvec3& toEye,
                   const std::vector<glm::dvec3>& outline, double fov) {
    Camera camera;
    camera.fov = fov;
    camera.target = scene.center();
    camera.eye = camera.target + toEye * scene.extent();
    camera.up = scene.up;
    if (std::abs(glm::dot(toEye, scene.up)) > 0.99) camera.up = horizontalAxes(scene.up)[1];
    return fitted(camera, outline, aspect);
}

/// The camera itself, with a field of view that holds what it saw.
Candidate throughTheSensor(const SurveyedScene& scene) {
    std::vector<double> xs, ys, depths;
    const glm::dvec3 right = glm::cross(scene.forward, scene.up);
    for (const SurveyPoint& p : scene.points) {
        const glm::dvec3 seen = p.position - *scene.sensor;
        const double depth = glm::dot(seen, scene.forward);
        depths.push_back(depth);
        xs.push_back(glm::dot(seen, right) / depth);
        ys.push_back(glm::dot(seen, scene.up) / depth);
    }
    const auto middleAndHalf = [](std::vector<double> values) {
        const double low = quantileOf(values, 0.003), high = quantileOf(std::move(values), 0.997);
        return std::array{(low + high) / 2, (high - low) / 2};
    };
    const auto x = middleAndHalf(std::move(xs)), y = middleAndHalf(std::move(ys));
    Candidate candidate;
    candidate.view.name = "as the camera saw it";
    candidate.view.inside = true;
    candidate.bonus = 10;  // nothing else shows such a scan without its shadows
    Camera& camera = candidate.view.camera;
    const double depth = quantileOf(std::move(depths), 0.5);
    camera.eye = *scene.sensor;
    camera.up = scene.up;
    camera.target = *scene.sensor + (scene.forward + x[0] * right + y[0] * scene.up) * depth;
    // Looking off the axis narrows what is seen at its side; the margin takes care of that.
    const double half = std::max(y[1], x[1] / aspect) / std::sqrt(1 + x[0] * x[0] + y[0] * y[0]);
    camera.fov = std::clamp(2 * std::atan(half / 0.9) * 180 / pi, 5.0, 120.0);
    return candidate;
}

/// Places on the ground where nobody would stand in a wall: the cell's distance from everything upright.
struct Place {
    glm::dvec3 eye;
    double clearance = 0;
};

class FloorPlan {
  public:
    explicit FloorPlan(const SurveyedScene& scene)
        : scene_(scene), axes_(horizontalAxes(scene.up)), middle_(scene.center()) {
        std::vector<double> heights;
        for (const SurveyPoint& p : scene.points) heights.push_back(glm::dot(p.position, scene.up));
        low_ = quantileOf(heights, 0.02);
        high_ = quantileOf(std::move(heights), 0.98);
        cell_ = std::max({glm::dot(scene.size(), glm::abs(axes_[0])),
                          glm::dot(scene.size(), glm::abs(axes_[1]))}) /
                side;
        if (!(cell_ > 0)) return;  // one point, or all above each other: nowhere to stand
        const double eyeLevel = eyeHeight();
        for (const SurveyPoint& p : scene.points) {
            Content& content = cells_[cellOf(p.position)];
            const double height = glm::dot(p.position, scene.up);
            content.low = std::min(content.low, height);
            if (height > low_ + 0.4 * eyeLevel && height < low_ + 1.3 * eyeLevel) content.blocked = true;
        }
    }

    /// The freest places, far from each other.
    std::vector<Place> places() const {
        std::vector<Place> all;
        for (const auto& [cell, content] : cells_) {
            if (content.blocked || content.low > low_ + 0.3 * eyeHeight()) continue;
            const glm::dvec3 beside =
                middle_ + cell_ * ((cell[0] + 0.5) * axes_[0] + (cell[1] + 0.5) * axes_[1]);
            const glm::dvec3 eye =
                beside + scene_.up * (content.low + eyeHeight() - glm::dot(beside, scene_.up));
            all.push_back({eye, clearance(cell)});
        }
        std::ranges::stable_sort(all, std::greater(), &Place::clearance);
        std::vector<Place> apart;
        for (const Place& place : all) {
            const bool isApart = std::ranges::all_of(apart, [&](const Place& other) {
                return glm::distance(place.eye, other.eye) > side / 6 * cell_;
            });
            if (isApart) apart.push_back(place);
            if (apart.size() == insidePlaces) break;
        }
        return apart;
    }

    /// As people stand: in rooms a little above half of their height, outdoors low over the ground.
    double eyeHeight() const {
        const double height = high_ - low_;
        return scene_.kind == SceneKind::Indoor ? 0.55 * height : std::min(0.5 * height, 2.5 * cell_);
    }

  private:
    static constexpr int side = 32, farthest = 8;
    using Cell = std::array<int, 2>;
    struct Content {
        double low = INFINITY;
        bool blocked = false;
    };

    /// From the middle, so that plans of small scenes far from the origin have few cells, too.
    Cell cellOf(const glm::dvec3& position) const {
        const glm::dvec3 at = (position - middle_) / cell_;
        return {int(std::floor(glm::dot(at, axes_[0]))), int(std::floor(glm::dot(at, axes_[1])))};
    }
    /// In cells; what was not scanned counts as blocked: nothing is known of it.
    double clearance(const Cell& at) const {
        double nearest = farthest;
        for (int dx = -farthest; dx <= farthest; ++dx)
            for (int dy = -farthest; dy <= farthest; ++dy) {
                const auto found = cells_.find({at[0] + dx, at[1] + dy});
                if (found == cells_.end() || found->second.blocked)
                    nearest = std::min(nearest, std::hypot(dx, dy));
            }
        return nearest;
    }

    const SurveyedScene& scene_;
    const std::array<glm::dvec3, 2> axes_;
    const glm::dvec3 middle_;
    double low_ = 0, high_ = 0, cell_ = 1;
    std::map<Cell, Content> cells_;
};

/// Views around from one place.
void lookAround(const SurveyedScene& scene, const glm::dvec3& eye, const std::string& name,
                std::vector<Candidate>& candidates) {
    for (int heading = 0; heading < headings; ++heading) {
        Candidate candidate;
        candidate.view.name = name;
        candidate.view.inside = true;
        Camera& camera = candidate.view.camera;
        camera.fov = insideFov;
        camera.up = scene.up;
        camera.eye = eye;
        camera.target = eye - direction(scene.up, heading, 0.09) * (0.3 * scene.extent());
        candidates.push_back(std::move(candidate));
    }
}

}  // namespace

std::vector<glm::dvec3> outlineOf(const std::vector<SurveyPoint>& points) {
    constexpr int directions = 192;
    const std::size_t rank = points.size() / 500;
    const auto box = boxOf(points);
    // In a cube, so that flat scans, and such of unlike units, have an outline in all directions, too.
    const glm::dvec3 unit = glm::max(box[1] - box[0], glm::dvec3(1e-300));
    std::vector<std::size_t> chosen;
    std::vector<std::pair<double, std::size_t>> along(points.size());
    for (int i = 0; i < directions; ++i) {
        // A Fibonacci sphere: evenly spread, and the same everywhere.
        const double z = 1 - (2 * i + 1.0) / directions, turn = i * pi * (3 - std::sqrt(5.0));
        const double r = std::sqrt(1 - z * z);
        const glm::dvec3 d(r * std::cos(turn), r * std::sin(turn), z);
        for (std::size_t k = 0; k < points.size(); ++k)
            along[k] = {-glm::dot((points[k].position - box[0]) / unit, d), k};
        std::ranges::nth_element(along, along.begin() + std::ptrdiff_t(rank));
        chosen.push_back(along[rank].second);
    }
    std::ranges::sort(chosen);
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    std::vector<glm::dvec3> outline;
    for (const std::size_t k : chosen) outline.push_back(points[k].position);
    return outline;
}

std::vector<Candidate> outsideCandidates(const SurveyedScene& scene, const std::vector<glm::dvec3>& outline) {
    std::vector<Candidate> candidates;
    if (scene.kind == SceneKind::DepthFrame) {
        const glm::dvec3 right = glm::cross(scene.forward, scene.up);
        for (const double turn : {0.0, 0.35, -0.35}) {
            const glm::dvec3 toEye = -std::cos(turn) * scene.forward + std::sin(turn) * right;
            candidates.push_back({{turn == 0  ? "front"
                                   : turn > 0 ? "front right"
                                              : "front left",
                                   false, cameraAlong(scene, toEye, outline, outsideFov)},
                                  turn == 0 ? 0.2 : 0.1});
        }
        return candidates;
    }
    if (scene.onlyFromAbove) {
        Candidate candidate{{"top", false, {}}, 0};
        Camera& camera = candidate.view.camera;
        camera.projection = Projection::Orthographic;
        camera.target = scene.center();
        camera.eye = camera.target + scene.up;
        camera.up = horizontalAxes(scene.up)[1];
        camera = fitted(camera, outline, aspect);
        return {candidate};
    }
    const bool isLand = scene.kind == SceneKind::Airborne || scene.kind == SceneKind::Street;
    const bool isMap = isLand || scene.up.z > 0.9;
    const std::vector<double> heights =
        isLand || scene.kind == SceneKind::Indoor ? std::vector{35.0, 52.0} : std::vector{10.0, 25.0, 40.0};
    for (const double down : heights)
        for (int heading = 0; heading < headings; ++heading)
            candidates.push_back(
                {{(isMap ? compass : sides)[std::size_t(heading)], false,
                  cameraAlong(scene, direction(scene.up, heading, down * pi / 180), outline, outsideFov)},
                 isLand ? (down < 36 ? 0.2 : 0) : (down > 9 && down < 36 ? 0.1 : 0)});
    candidates.push_back({{"top", false, cameraAlong(scene, scene.up, outline, outsideFov)}, -0.4});
    return candidates;
}

std::vector<Candidate> insideCandidates(const SurveyedScene& scene) {
    if (scene.kind == SceneKind::DepthFrame) return {throughTheSensor(scene)};
    std::vector<Candidate> candidates;
    if (scene.sensor) {
        lookAround(scene, *scene.sensor, "from the scanner", candidates);
        return candidates;
    }
    if (scene.kind != SceneKind::Indoor && scene.kind != SceneKind::Street) return candidates;
    for (const Place& place : FloorPlan(scene).places()) lookAround(scene, place.eye, "inside", candidates);
    return candidates;
}

}  // namespace scancast
