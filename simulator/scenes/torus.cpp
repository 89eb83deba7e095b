// A ring, 1 m from its axis to the middle of its tube and 0.4 m thick from there: curved in two directions,
// in part the wrong way round (a saddle), and from most sides in front of itself.
#include <cmath>

#include "simulator/materials.hpp"

namespace scancast {
namespace {

/// Checkers along both turns, hue all around, pale bands every quarter.
class RingMaterial final : public Material {
  public:
    void apply(const Patch& patch, SurfacePoint& point) const override {
        const double around = point.s / patch.lengthU, across = point.t / patch.lengthV;
        const bool dark = ((int(std::floor(around * 48)) + int(std::floor(across * 16))) & 1) != 0;
        const auto wave = [&](double shift) {
            return 0.55F + 0.4F * float(std::cos(6.283185307179586 * (around + shift)));
        };
        point.color = glm::vec3(wave(0), wave(-1.0 / 3), wave(1.0 / 3)) * (dark ? 0.45F : 1.0F);
        const double band = around * 4 - std::floor(around * 4);
        if (band < 0.06) point.color = glm::vec3(0.94F, 0.92F, 0.86F);
        point.reflectance = dark ? 0.3F : 0.7F;
        point.classification = std::uint8_t(1 + int(around * 4) % 4);
    }
};

}  // namespace

Model makeTorus() {
    Model model;
    model.smallestCell = 0.04;
    model.largestCell = 0.5;
    model.add(Patch::torus({0, 0, 0}, {0, 0, 1}, 1, 0.4), model.add<RingMaterial>());
    for (int i = 0; i < 6; ++i) {
        const double turn = 1.0471975511965976 * i;
        model.stations.push_back({5 * std::cos(turn), 5 * std::sin(turn), (i & 1) != 0 ? 2.5 : -2.5});
    }
    for (const double z : {-5.0, 5.0}) model.stations.push_back({0, 0, z});
    return model;
}

}  // namespace scancast
