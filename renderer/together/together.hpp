// Several clouds as one, to be drawn in one picture: the nodes of all in one octree with as many roots, each moved by its
// cloud's shift; samples stay where they are, and come from the clouds' own stores. What a cloud is tinted with is in its
// samples when they are decoded, before a device sees them, so pictures are the same on every device
// (docs/decisions/033-several-clouds-in-one-octree.md). Everything that draws a cloud draws this one.
//
// Immutable; shared between threads. Pipeline: catalog → **together** → plan, prepare; pick asks it whose a node is.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/view/viewed_clouds.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/residency/block_cache.hpp"
#include "renderer/together/painted_file.hpp"

namespace scancast {

/// A cloud that is shown.
struct TogetherMember {
    std::string name;                    ///< that answers and messages call it by
    std::shared_ptr<const Cloud> cloud;  ///< as it is by itself
    glm::dvec3 shift{0};                 ///< file units
    std::optional<Rgb8> tint{};
    bool hidden =
        false;  ///< only its place in the list, and what the view's own cloud decides, are left of it
};

struct Together {
    struct Place {
        std::uint32_t member, node;
    };

    std::vector<TogetherMember> members;
    std::vector<Place> places;  ///< by the octree's nodes: whose each is, and which one there
    bool byCloud = false;       ///< samples have their cloud's colour instead of their own

    std::vector<std::optional<Paint>> paints;  ///< by member: what its samples are painted with
    std::vector<std::shared_ptr<SampleStore>>
        stores;                           ///< by member: where they come from; empty where nothing is shown
    std::shared_ptr<const void> counted;  ///< the memory of the nodes
};

/// Nodes that clouds may have together, and bytes that each takes once more then.
inline constexpr std::uint64_t mostNodesTogether = 300'000;
inline constexpr std::uint64_t bytesPerNodeTogether = sizeof(Node) + sizeof(Together::Place);

/// The first member is the view's own cloud: its origin, CRS, look and stations are the result's, whose look sees all that is
/// shown. `byCloud`: each cloud in one colour, its tint or cloudColors by its place. `like`: one of before; where the same samples
/// are shown, only elsewhere, devices keep what they have of it. Takes milliseconds, and waits for nothing. Memory is counted in the
/// cache, whose clouds the members are, or clouds in memory. Errors, field `with`: Unsupported for another CRS or unit than the own
/// cloud's, and where clouds are with other processes; ResourceLimit for too many nodes; Unavailable where all that are put together
/// at present, by anybody, take a quarter of the cache's memory already.
Expected<std::shared_ptr<const Cloud>> putTogether(std::vector<TogetherMember> members, bool byCloud,
                                                   const std::shared_ptr<BlockCache>& cache,
                                                   const Cloud* like = nullptr);

/// The view's clouds as members, the own one first. `find`: the cloud of a name.
template <class Find>
Expected<std::vector<TogetherMember>> membersOf(const ViewedClouds& viewed, TogetherMember own, Find find) {
    std::vector<TogetherMember> members{std::move(own)};
    for (const ViewedCloud& one : viewed) {
        if (one.cloud == ownCloudName) {
            members.front().shift = one.shift;
            members.front().tint = one.tint;
            members.front().hidden = one.hidden;
            continue;
        }
        auto cloud = find(one);
        if (!cloud) return passOn(std::move(cloud));
        members.push_back({one.cloud, std::move(*cloud), one.shift, one.tint, one.hidden});
    }
    return members;
}

}  // namespace scancast
