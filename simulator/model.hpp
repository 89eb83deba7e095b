// What a scene is made of: patches of surface with a material, things that cast shadows, the places where the
// scanner stood, and the light. Built once by a scene, then read by all threads. Metres, Z up, east = +x,
// north = +y; positions are relative to the scene's origin.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "simulator/random.hpp"

namespace scancast {

/// A whole turn.
inline constexpr double tau = 2 * std::numbers::pi;

/// A point on its way from a patch to the scan. Materials read where it is and write what it looks like.
struct SurfacePoint {
    double s = 0, t = 0;  ///< metres along the patch's two directions
    glm::dvec3 position{0};
    glm::vec3 normal{0, 0, 1};
    glm::vec3 color{0.5F};     ///< sRGB, 0 … 1, before light
    float reflectance = 0.5F;  ///< in the scanner's infrared, 0 … 1
    float openness = 1;  ///< how much of the sky the material itself leaves free: recesses, joints, leaves
    float sunlit = 1;    ///< part of the sun or lamp that the material itself lets through
    std::uint8_t classification = 0;
    PointRandom* random = nullptr;

    void raise(double height) { position += glm::dvec3(normal) * height; }
};

class Patch;

/// Stateless after construction; called by all threads at once.
class Material {
  public:
    virtual ~Material() = default;
    virtual void apply(const Patch& patch, SurfacePoint& point) const = 0;
    /// How far it moves points off their patch along the normal, at most, in metres; either way.
    virtual double relief() const { return 0; }
};

/// A piece of surface with two parameters in [0, 1)². All shapes keep areas: uniform parameters are uniform
/// points.
class Patch {
  public:
    enum class Shape : std::uint8_t { Trapezoid, Tube, Ball, Disc, Torus };

    /// Spanned by u (bottom edge) and v (left edge); the top edge is `taper` × u (1 = parallelogram, 0 =
    /// triangle).
    static Patch trapezoid(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, double taper = 1);
    /// Round, from `base` along `axis`, radius r0 at the base and r1 at the end; the normal points outwards.
    static Patch tube(glm::dvec3 base, glm::dvec3 axis, double r0, double r1);
    static Patch ball(glm::dvec3 center, double radius);
    /// Horizontal ring between two radii, facing up.
    static Patch disc(glm::dvec3 center, double r0, double r1);
    /// A ring of radius `ring` around `axis`, as thick as a tube of radius `tube` < `ring`.
    static Patch torus(glm::dvec3 center, glm::dvec3 axis, double ring, double tube);

    SurfacePoint at(double a, double b) const;
    double area() const;
    /// Low and high corner of a box around the patch, without relief.
    std::array<glm::dvec3, 2> bounds() const;

    Shape shape = Shape::Trapezoid;
    glm::dvec3 origin{0}, u{0}, v{0};
    double taper = 1, radius0 = 0, radius1 = 0;
    glm::dvec3 normal{0, 0, 1};  ///< trapezoids; sidewards axis of tubes and tori
    glm::dvec3 lightOffset{0};   ///< where light is tested, if not 0.3 m before the surface: for recesses
    double lengthU = 0, lengthV = 0;  ///< metres, for cutting into cells and for the material's coordinates
    double density = 1;               ///< points a square metre, relative
    const Material* material = nullptr;
    bool hasNormal = true;  ///< false: foliage and the like, where a normal means nothing
    bool hideInside =
        false;        ///< cells inside an occluder get no points: the ground under a house, walls between two
    int mirror = -1;  ///< index of the mirror in which this patch is seen, or -1
    /// Points in rows, shaken, instead of on a golden-ratio lattice: as from a flatbed or a structured-light
    /// scanner.
    bool regular = false;
    bool ownShadows = false;                 ///< occluders leave it alone: its material knows what is lit
    std::array<std::uint32_t, 3> corners{};  ///< of a triangle of a mesh: its material's vertices
};

/// What keeps light away: a convex body (planes n·x ≤ w) or a ball of leaves.
struct Occluder {
    std::array<glm::vec4, 7> planes{};
    int planeCount = 0;  ///< 0 = ball
    glm::vec3 center{0};
    float radius = 0;    ///< of the ball, or of a ball around the body
    bool solid = false;  ///< a building: nothing inside it, and no ground under it, is ever scanned

    static Occluder box(glm::vec3 low, glm::vec3 high);
    static Occluder leaves(glm::vec3 center, float radius);
    void addPlane(glm::vec3 normal, glm::vec3 through);

    /// Whether the ray from `from` meets the body before `reach`; `direction` has unit length.
    bool blocks(glm::vec3 from, glm::vec3 direction, float reach = 1e9F) const;
    /// Signed distance of convex bodies, or a little less outside edges.
    float distance(glm::vec3 at) const;
};

struct Light {
    enum class Kind : std::uint8_t { None, Sun, Lamp };
    Kind kind = Kind::None;
    glm::vec3 towards{0, 0, 1};             ///< unit direction to the sun, or the lamp's position
    glm::vec3 color{0}, sky{1}, ground{1};  ///< linear
    float lampReach = 3;                    ///< distance at which a lamp's light has fallen to a half
};

struct Model {
    std::vector<Patch> patches;
    std::vector<std::unique_ptr<const Material>> materials;
    std::vector<Occluder> occluders;
    std::vector<glm::dvec3> stations;
    std::vector<Mirror> mirrors;  ///< relative to the origin
    Light light;
    double rangeNoise = 0.002;  ///< standard deviation along the beam, metres
    double colorNoise = 0.02;
    double largestRelief = 0;  ///< how far materials move points off their patches, at most
    double smallestCell = 0.5, largestCell = 4;
    glm::dvec3 defaultOrigin{0};
    Attributes attributes{true, true, true, true};

    template <class M, class... Arguments>
    const Material* add(Arguments&&... arguments) {
        materials.push_back(std::make_unique<const M>(std::forward<Arguments>(arguments)...));
        return materials.back().get();
    }
    Patch& add(Patch patch, const Material* material, double density = 1) {
        patch.material = material;
        patch.density = density;
        return patches.emplace_back(std::move(patch));
    }
    /// The five visible sides of an upright box, turned by `angle` around its centre.
    void addBox(glm::dvec3 center, glm::dvec3 size, const Material* material, double angle = 0,
                double density = 1, bool bottom = false);
};

/// The scenes, each in its own file.
Model makeTown();
Model makeRoom();
Model makeSphere();
Model makePlane();
Model makeCube();
Model makeTorus();
Model makeSign();
Model makeStatue();
Model makeBridge();

/// The scene of that name (scene.hpp lists them), or nothing.
std::optional<Model> makeScene(std::string_view name);

}  // namespace scancast
