#include "renderer/cloud/build/frame/frame_cloud.hpp"

#include <spdlog/fmt/fmt.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <new>

#include "renderer/cloud/build/chunks/staging.hpp"
#include "renderer/cloud/build/frame/frame_octree.hpp"
#include "renderer/cloud/build/grid.hpp"
#include "renderer/cloud/build/nodes/spacing.hpp"
#include "renderer/cloud/build/revision.hpp"
#include "renderer/cloud/build/value_ranges.hpp"

namespace scancast {

namespace {

Expected<std::array<glm::dvec3, 2>> boundsOfFrame(const PointBatch& points) {
    const std::array<glm::dvec3, 2> bounds = boundsOf(points.position);
    for (const glm::dvec3& corner : bounds)
        for (int a = 0; a < 3; ++a)
            if (!(std::abs(corner[a]) <= farthestCoordinate))
                return fail(
                    ErrorCode::Malformed,
                    fmt::format(
                        "A point of the frame has the coordinate {:g}; beyond {:g} they are taken for "
                        "damage.",
                        corner[a], farthestCoordinate));
    return bounds;
}

/// What the first frame says of colours and coordinates.
void settleValues(const PointFrame& frame, CloudFacts& facts) {
    // As the header says: one frame of a wall in one colour does not make a source one without colours.
    const Attributes attributes = facts.attributes;
    ValueRanges values;
    values.add(frame.points);
    values.settle(facts);
    facts.attributes = attributes;
    facts.constant = {};
}

CloudFacts factsOfFrame(const PointFrame& frame, const FrameOptions& options,
                        const std::array<glm::dvec3, 2>& bounds) {
    CloudFacts facts;
    const ScanHeader& header = frame.header;
    facts.title = options.title;
    facts.format = header.format;
    facts.bounds = bounds;
    facts.points = frame.points.size();
    facts.droppedPoints = frame.droppedPoints;
    facts.attributes = header.attributes;
    facts.attributes.normal |= options.surfels;
    facts.attributes.nearInfrared = false;  // frames keep nothing beside their samples
    facts.notes = frame.notes;
    for (const std::uint8_t c : frame.points.classification) ++facts.classCounts[c];
    facts.crsWkt = header.crsWkt;
    facts.crsEpsg = header.crsEpsg;
    facts.surfels = options.surfels;
    facts.scanner = header.scannerOrigin;
    if (header.attributes.normal)
        facts.sides = KnownSides{KnownSides::By::File, 1};
    else if (header.scannerOrigin && options.surfels)
        facts.sides = KnownSides{KnownSides::By::Scanner, 1};
    facts.oriented = facts.sides.has_value();
    if (options.basis == nullptr) {
        facts.origin = roundOrigin(bounds);
        settleValues(frame, facts);
    } else {
        facts.origin = options.basis->origin;
        facts.usual = options.basis->usual;
        facts.intensityRange = options.basis->intensityRange;
        facts.look = options.basis->look;
    }
    return facts;
}

Expected<std::shared_ptr<const Cloud>> buildFrame(const PointFrame& frame, const FrameOptions& options) {
    const PointBatch& points = frame.points;
    if (points.size() == 0) return fail(ErrorCode::Empty, "The frame has no points.");
    if (points.size() > std::numeric_limits<std::uint32_t>::max())
        return fail(ErrorCode::ResourceLimit, "The frame has more points than a frame can have.");
    const auto bounds = boundsOfFrame(points);
    if (!bounds) return passOn(bounds);
    auto cloud = std::make_shared<Cloud>();
    static_cast<CloudFacts&>(*cloud) = factsOfFrame(frame, options, *bounds);
    BuiltOctree octree;
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        std::optional<glm::dvec3> scanner;
        if (cloud->scanner) scanner = *cloud->scanner - cloud->origin;
        const FrameOrder order = orderFrame(points, *bounds, cloud->origin);
        const FrameSurface surface = estimateFrameSurface(order, scanner);
        octree = buildFrameOctree({order, surface, cloud->surfels, cloud->oriented});
    });
    cloud->spacing = typicalSpacing(octree.nodes);
    cloud->revision = revisionOf(*cloud, octree);
    std::vector<Node> nodes;
    nodes.reserve(octree.nodes.size());
    for (const StoredNode& n : octree.nodes) nodes.push_back(n.node);
    cloud->octree = Octree(std::move(nodes), std::move(octree.samples));
    return cloud;
}

}  // namespace

FrameBasis basisOf(const Cloud& first) {
    return {first.origin, first.usual, first.intensityRange, first.look};
}

Expected<std::shared_ptr<const Cloud>> buildFrameCloud(const PointFrame& frame, const FrameOptions& options) {
    try {
        return buildFrame(frame, options);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, "There is not enough memory for this frame.");
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, fmt::format("The frame could not be built: {}.", e.what()));
    }
}

}  // namespace scancast
