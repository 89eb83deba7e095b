#include "renderer/cloud/cloud.hpp"

#include <spdlog/fmt/fmt.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <new>
#include <numbers>

#include "renderer/cloud/octree_builder.hpp"
#include "renderer/cloud/revision.hpp"
#include "renderer/cloud/staging.hpp"

namespace scancast {

namespace {

/// The minimum corner, rounded down to a power of ten not above the cloud's size: short to write, and exact.
glm::dvec3 roundOrigin(const std::array<glm::dvec3, 2>& bounds) {
    const glm::dvec3 size = bounds[1] - bounds[0];
    const double largest = std::max({size.x, size.y, size.z});
    const int digits = largest > 0 ? std::clamp(int(std::floor(std::log10(largest))), -6, 15) : 0;
    const double unit = std::pow(10.0, std::abs(digits));
    glm::dvec3 origin;
    for (int a = 0; a < 3; ++a)
        origin[a] =
            digits >= 0 ? std::floor(bounds[0][a] / unit) * unit : std::floor(bounds[0][a] * unit) / unit;
    return origin + 0.0;  // no -0
}

/// Median of the leaves' spacings, each leaf counting as many times as it has points.
double typicalSpacing(const Octree& octree) {
    std::vector<std::pair<float, std::uint64_t>> leaves;
    std::uint64_t points = 0;
    for (const Node& n : octree.nodes()) {
        if (!n.isLeaf()) continue;
        leaves.emplace_back(n.meanSpacing, n.points);
        points += n.points;
    }
    std::sort(leaves.begin(), leaves.end());
    std::uint64_t below = 0;
    for (const auto& [spacing, count] : leaves) {
        below += count;
        if (2 * below >= points) return spacing;
    }
    return 0;
}

/// Models, unlike surveys, are mostly made with Y up, and set down on the plane y = 0 around the origin.
bool standsOnXZ(const std::array<glm::dvec3, 2>& bounds) {
    const glm::dvec3 size = bounds[1] - bounds[0];
    const auto standsOn = [&](int axis) { return std::abs(bounds[0][axis]) <= 0.02 * size[axis]; };
    const auto straddles = [&](int axis) { return bounds[0][axis] < 0 && bounds[1][axis] > 0; };
    return standsOn(1) && !standsOn(2) && straddles(0) && straddles(2);
}

Expected<std::shared_ptr<const Cloud>> build(PointSource& source, const BuildOptions& options,
                                             const ProgressSink& progress) {
    const ScanHeader header = source.header();
    ProgressMeter reading(progress, "reading", header.points.value_or(0));
    auto scan = stage(source, reading);
    if (!scan) return tl::unexpected(scan.error());

    auto cloud = std::make_shared<Cloud>();
    cloud->title = options.title;
    cloud->format = header.format;
    cloud->bounds = scan->bounds;
    cloud->origin = roundOrigin(scan->bounds);
    cloud->points = scan->points;
    cloud->droppedPoints = scan->droppedPoints;
    cloud->attributes = header.attributes;
    cloud->intensityRange = scan->intensityRange;
    cloud->classCounts = scan->classCounts;
    cloud->crsWkt = header.crsWkt;
    cloud->crsEpsg = header.crsEpsg;

    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        const Grid grid = chooseGrid(*scan, header);
        const auto points = unstage(*scan, header, grid);
        cloud->octree = buildOctree({.points = std::span(points.get(), cloud->points),
                                     .grid = grid,
                                     .origin = cloud->origin,
                                     .attributes = header.attributes,
                                     .leafPoints = options.shape.leafPoints},
                                    progress);
    });
    cloud->spacing = typicalSpacing(cloud->octree);
    cloud->revision = revisionOf(*cloud);
    return cloud;
}

}  // namespace

Expected<std::shared_ptr<const Cloud>> buildCloud(PointSource& source, const BuildOptions& options,
                                                  const ProgressSink& progress) {
    try {
        return build(source, options, progress);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit,
                    "There is not enough memory for this scan; about 60 bytes a point are needed while it is "
                    "loaded.");
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, fmt::format("The octree could not be built: {}.", e.what()));
    }
}

Camera Cloud::defaultCamera(double aspect) const {
    Camera camera;
    const double down = std::numbers::pi / 6, turn = std::numbers::pi / 4;
    // From the target to the eye: south is -y, east is +x.
    const double south = std::cos(down) * std::cos(turn), east = std::cos(down) * std::sin(turn);
    const bool yIsUp = standsOnXZ(bounds);
    camera.up = yIsUp ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 back =
        yIsUp ? glm::dvec3(east, std::sin(down), south) : glm::dvec3(east, -south, std::sin(down));
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    const glm::dvec3 up = glm::cross(back, right);
    const double margin = 1.08;
    const double tanUp = std::tan(camera.fov * std::numbers::pi / 360) / margin;
    const double tanRight = tanUp * (aspect > 0 && std::isfinite(aspect) ? aspect : 1.0);

    // Every corner bounds the eye from four sides: in the camera's axes, |corner.x - eye.x| ≤ tan · (eye.z -
    // corner.z). The tightest pair per axis meets where that axis just fills the picture; the farther of the
    // two distances wins.
    const glm::dvec3 middle = (bounds[0] + bounds[1]) * 0.5, half = (bounds[1] - bounds[0]) * 0.5;
    double rightMost = 0, leftMost = 0, topMost = 0, bottomMost = 0, widest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 c = half * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const double x = glm::dot(c, right), y = glm::dot(c, up), z = glm::dot(c, back);
        rightMost = std::max(rightMost, z + x / tanRight);
        leftMost = std::max(leftMost, z - x / tanRight);
        topMost = std::max(topMost, z + y / tanUp);
        bottomMost = std::max(bottomMost, z - y / tanUp);
        widest = std::max({widest, std::abs(y), std::abs(x) * tanUp / tanRight});
    }
    const double offsetRight = tanRight * (rightMost - leftMost) / 2,
                 offsetUp = tanUp * (topMost - bottomMost) / 2;
    const double fitting = std::max(rightMost + leftMost, topMost + bottomMost) / 2;
    // A cloud of one point has no size; it is looked at from a distance at which the eye differs from the
    // target.
    const double distance = std::max({fitting, spacing * 10, glm::length(middle) * 1e-9, 1e-9});
    camera.target = middle + right * offsetRight + up * offsetUp;
    camera.eye = camera.target + back * distance;
    camera.viewHeight = std::max(2 * margin * (widest + std::abs(offsetUp)), distance * 1e-3);
    return camera;
}

}  // namespace scancast
