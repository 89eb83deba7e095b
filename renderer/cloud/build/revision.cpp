#include "renderer/cloud/build/revision.hpp"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <memory>
#include <new>

namespace scancast {

namespace {

/// Fields one by one: structs have padding, and padding has no value.
class Digest {
  public:
    Digest() : state_(XXH3_createState(), &XXH3_freeState) {
        if (!state_) throw std::bad_alloc();
        XXH3_128bits_reset(state_.get());
    }
    void bytes(const void* data, std::size_t size) { XXH3_128bits_update(state_.get(), data, size); }
    template <class T>
    requires std::is_arithmetic_v<T>
    void operator()(T value) { bytes(&value, sizeof value); }
    void operator()(const glm::dvec3& v) {
        for (int a = 0; a < 3; ++a) (*this)(v[a]);
    }
    std::string hex() const {
        const XXH128_hash_t h = XXH3_128bits_digest(state_.get());
        return fmt::format("{:016x}{:016x}", h.high64, h.low64);
    }

  private:
    std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

void addNode(Digest& add, const Node& n) {
    add(n.boxMin);
    add(n.step);
    add(n.boxMax);
    add(n.center);
    add(n.radius);
    add(n.spacing);
    add(n.meanSpacing);
    add(n.radiusUnit);
    for (int a = 0; a < 3; ++a) add(n.cone.axis[a]);
    add(n.cone.halfAngle);
    add(n.parent);
    add(n.firstChild);
    add(n.childCount);
    add(n.level);
    add(n.confidence);
    add(n.sampleCount);
    add(n.firstSample);
    add(n.points);
}

}  // namespace

std::string revisionOf(const CloudFacts& cloud, const BuiltOctree& octree) {
    Digest add;
    add(cloud.origin);
    add(cloud.bounds[0]);
    add(cloud.bounds[1]);
    add(cloud.attributes.color);
    add(cloud.attributes.intensity);
    add(cloud.attributes.classification);
    add(cloud.attributes.normal);
    add(cloud.intensityRange[0]);
    add(cloud.intensityRange[1]);
    add(cloud.spacing);
    if (cloud.usual) {
        for (const glm::dvec3& corner : cloud.usual->position) add(corner);
        for (const double end : cloud.usual->intensity) add(end);
        for (const double level : cloud.usual->brightness) add(level);
        if (hasCurvature(cloud))
            for (const double end : cloud.usual->curvature) add(end);
    }
    for (const Mirror& m : cloud.mirrors) {
        add(m.center);
        add(m.normal);
        add(m.up);
        add(m.width);
        add(m.height);
        for (const std::uint8_t c : m.tint) add(c);
    }
    add(cloud.surfels);
    add(cloud.oriented);
    for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
        addNode(add, octree.nodes[i].node);
        add(octree.sampleHashes[i]);
    }
    // Pictures may be coloured and filtered by them.
    for (const KeptColumn& kept : cloud.columns) {
        add(kept.column.scale);
        add(kept.column.offset);
    }
    if (!cloud.columns.empty())
        for (const BlockPlace& place : octree.planes) add(place.checksum);
    return add.hex();
}

}  // namespace scancast
