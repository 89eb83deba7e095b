#include "renderer/device/plan/screen_plan.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {

PhongNumbers phongNumbers(const PhongPass& pass, const Sight& sight, const glm::dvec2& jitter, int x, int y) {
    const glm::dvec2 axis = sight.center() + jitter;
    PhongNumbers n;
    n.perspective = sight.perspective();
    n.x = x;
    n.y = y;
    n.offsetX = static_cast<float>(0.5 - axis.x);
    n.offsetY = static_cast<float>(0.5 - axis.y);
    n.inverseFocal = static_cast<float>(std::min(1 / sight.viewpoint->pixelsPerUnit, 1e30));
    n.ambient = pass.ambient;
    n.headlight = pass.headlight;
    n.directional = pass.directional;
    n.specular = pass.specular;
    return n;
}

EyeDomeNumbers eyeDomeNumbers(const EyeDomePass& pass) {
    const double radius = std::clamp(pass.radiusPx, 0.0f, 64.0f);
    EyeDomeNumbers n;
    n.reach = static_cast<std::int32_t>(std::ceil(radius));
    for (int k = 0; k < 8; ++k) {
        const double angle = k * 0.785398163397448309616;
        n.x[k] = static_cast<std::int32_t>(std::lround(radius * std::cos(angle)));
        n.y[k] = static_cast<std::int32_t>(std::lround(radius * std::sin(angle)));
    }
    constexpr double log2e = 1.44269504088896340736;
    n.factor = static_cast<float>(300.0 * std::clamp(pass.strength, 0.0f, 1000.0f) / 8 * log2e);
    return n;
}

}  // namespace scancast
