// A cube, 2 m along each edge: six planes that meet at sharp creases, told apart by colour, with a pattern so
// fine that blurred creases and blurred faces both show.
#include <algorithm>
#include <cmath>

#include "simulator/materials.hpp"

namespace scancast {
namespace {

/// Checkers of 1/10 m with a disc in each dark square, and a pale rim that ends exactly at the crease.
class FaceMaterial final : public Material {
  public:
    FaceMaterial(glm::vec3 color, std::uint8_t classification)
        : color_(color), classification_(classification) {}
    void apply(const Patch& patch, SurfacePoint& point) const override {
        constexpr double square = 0.1;
        const double u = point.s / square, v = point.t / square;
        const bool dark = ((int(std::floor(u)) + int(std::floor(v))) & 1) != 0;
        const bool disc = std::hypot(u - std::floor(u) - 0.5, v - std::floor(v) - 0.5) < 0.3;
        const float slope = 0.85F + 0.15F * float(point.t / patch.lengthV);
        point.color = (dark ? (disc ? blend(color_, glm::vec3(1), 0.65F) : color_ * 0.45F) : color_) * slope;
        const double edge =
            std::min(std::min(point.s, patch.lengthU - point.s), std::min(point.t, patch.lengthV - point.t));
        if (edge < 0.03) point.color = blend(color_, glm::vec3(1), 0.35F);
        point.reflectance = dark ? 0.3F : 0.7F;
        point.classification = classification_;
    }

  private:
    glm::vec3 color_;
    std::uint8_t classification_;
};

}  // namespace

Model makeCube() {
    Model model;
    model.smallestCell = 0.04;
    model.largestCell = 0.5;
    struct Face {
        glm::dvec3 corner, u, v;
        int color;
    };
    static const std::array faces{Face{{1, -1, -1}, {0, 2, 0}, {0, 0, 2}, 0xd1495b},    // east
                                  Face{{-1, 1, -1}, {0, -2, 0}, {0, 0, 2}, 0x2e8bc0},   // west
                                  Face{{1, 1, -1}, {-2, 0, 0}, {0, 0, 2}, 0xedae49},    // north
                                  Face{{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}, 0x3d9970},   // south
                                  Face{{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, 0xe9e4d8},    // top
                                  Face{{-1, 1, -1}, {2, 0, 0}, {0, -2, 0}, 0x7a4ea3}};  // bottom
    std::uint8_t number = 1;
    for (const Face& face : faces)
        model.add(Patch::trapezoid(face.corner, face.u, face.v),
                  model.add<FaceMaterial>(rgb(face.color), number++));
    for (const glm::dvec3 at :
         {glm::dvec3(6, 0, 0), {-6, 0, 0}, {0, 6, 0}, {0, -6, 0}, {0, 0, 6}, {0, 0, -6}})
        model.stations.push_back(at);
    return model;
}

}  // namespace scancast
