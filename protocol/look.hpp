// How a cloud is best seen when nobody has said anything: what kind of scene it is, which way is up, where to
// stand, how to colour and light it - and why. Decided once (renderer/look), kept in the cloud file, told by
// `info` and the API as `look` (PROTOCOL.md, "The look of a cloud"). A view's own words always win.
//
// Plain values and pure functions; any thread. File coordinates, the file's unit.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/view/view.hpp"

namespace scancast {

enum class SceneKind : std::uint8_t {
    Airborne,    ///< a landscape scanned from above
    Street,      ///< scanned outdoors from the ground
    Indoor,      ///< rooms, scanned from inside
    Object,      ///< a thing that one walks around
    DepthFrame,  ///< what a camera saw from one place
};
inline constexpr std::array<std::string_view, 5> sceneKindNames{"airborne", "street", "indoor", "object",
                                                                "depth-frame"};
constexpr std::string_view name(SceneKind kind) {
    return sceneKindNames[std::size_t(kind)];
}

/// One place to look from.
struct LookView {
    std::string name;     ///< for people: "from the south-east", "top", "inside"
    bool inside = false;  ///< stands in the scene, where it is; else fitted to the picture from outside
    Camera camera;        ///< of a picture of 16:9
    bool operator==(const LookView&) const = default;
};

struct Look {
    static constexpr std::size_t mostViews = 6, mostOutline = 256;

    SceneKind kind = SceneKind::Object;
    std::string reason;                  ///< why all of this, in sentences
    glm::dvec3 up{0, 0, 1};              ///< unit vector
    std::array<glm::dvec3, 2> bounds{};  ///< least, greatest, without stray points
    std::vector<glm::dvec3> outline;     ///< outermost points, what cameras are fitted to; at least one
    double noise = 0;  ///< typical distance of points from the surface through their neighbours
    Style style;
    std::vector<LookView> views;  ///< the best first; at least one
    bool operator==(const Look&) const = default;
};

/// `view`'s camera for a picture of this width / height: moved along its own direction until the outline
/// fills the picture, but for a margin of 6 % at each of the two sides that it reaches first. Cameras inside
/// stay.
Camera cameraFor(const Look& look, const LookView& view, double aspect);
/// The same for any camera from outside and any points.
Camera fitted(const Camera& camera, const std::vector<glm::dvec3>& outline, double aspect);

nlohmann::json toJson(const Look& look);
/// `base` with the fields that `changes` has; unknown ones are errors. Errors: InvalidArgument with the JSON path
/// as field.
Expected<Look> applyLook(const Look& base, const nlohmann::json& changes);
/// Whether a cloud can be shown by it: it has a view and an outline.
Expected<void> validate(const Look& look);

}  // namespace scancast
