// The truth of a scene: what a ray meets first, and what it looks like there. Meets patches exactly, so that
// it agrees with the points that `simulate` yields at noise 0. Where a material moves points off its patch -
// facades, cobbles, roof tiles, bark: only in the town - the relief is followed step by step, good to about a
// millimetre but at its own edges; leaves, whose points lie scattered in depth, are shown as such.
// Built once, then read by all threads.
#pragma once

#include <memory>
#include <optional>

#include "simulator/scene.hpp"
#include "tests/ground_truth/box_tree.hpp"

namespace scancast {

struct RayHit {
    double t = 0;               ///< in lengths of the ray's direction
    glm::dvec3 position{0};     ///< in the points' (file) coordinates; in a mirror: of the image behind it
    glm::vec3 normal{0, 0, 1};  ///< the surface's own, as points carry it; may face away from the ray
    glm::vec3 color{0};         ///< sRGB, 0 … 1, in the scene's light: what a point there is given
    std::uint8_t classification = 0;
    std::uint32_t patch = 0;  ///< index into Model::patches
    bool reflected = false;   ///< seen in a mirror; then t counts the whole way
};

/// What a mirror's glass shows.
enum class Glass : std::uint8_t {
    Reflects,  ///< the scene in front of it, tinted, one bounce
    Open,      ///< a hole in the wall
};

class RayCaster {
  public:
    /// The scene that `simulate` would scan; only its name and origin matter. Errors: NotFound,
    /// ResourceLimit.
    static Expected<RayCaster> create(const SceneOptions& options);
    /// The same for a model of one's own; `origin` is what its points have added.
    explicit RayCaster(Model model, glm::dvec3 origin = glm::dvec3(0));
    RayCaster(RayCaster&&) noexcept;
    RayCaster& operator=(RayCaster&&) noexcept;
    ~RayCaster();

    /// The first thing with low < t < high, from either side. `ray` in the points' coordinates. `sample`
    /// picks the grain that materials have: the same number, the same grain.
    std::optional<RayHit> cast(const Ray& ray, double low, double high, std::uint64_t sample = 0,
                               Glass glass = Glass::Reflects) const;
    /// Whether nothing lies between an eye and a point of the surface but its last `slack` metres. Mirrors do
    /// not help.
    bool sees(const glm::dvec3& eye, const glm::dvec3& point, double slack) const;

    const Model& model() const;
    const glm::dvec3& origin() const;

  private:
    struct Scene;
    std::unique_ptr<const Scene> scene_;
};

}  // namespace scancast
