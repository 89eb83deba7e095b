// Clicks into pictures of the generated town, as somebody who measures makes them: a pixel, what the server answers, and where a ray
// through the pixel's middle meets the town itself. Used by oracle_measure and bench_measure.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "renderer/device/device.hpp"
#include "renderer/pick/pick.hpp"
#include "renderer/render.hpp"
#include "tests/ground_truth/ray_caster.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

struct Click {
    glm::dvec3 truth{0}, point{0}, surface{0};
};

/// Pictures from all around, of houses and of what stands before them; 1280 x 720, as the page asks for them. Clicks on leaves, whose points lie
/// scattered in depth, and beyond `away` are left out.
inline std::vector<Click> clicksInPictures(Device& device, const Cloud& cloud, const RayCaster& town,
                                           int pictures, int perPicture) {
    std::vector<Click> clicks;
    for (int k = 0; k < pictures; ++k) {
        const double angle = 2 * 3.14159265358979 * (k + 0.3) / pictures;
        View view = defaultView(cloud, 1280, 720);
        view.camera.viewMatrix.reset();
        view.camera.projection = Projection::Perspective;
        view.camera.target =
            town.origin() + glm::dvec3(15 * std::cos(5 * angle), 15 * std::sin(3 * angle), 4);
        view.camera.eye = view.camera.target + glm::dvec3(45 * std::cos(angle), 45 * std::sin(angle), 35);
        view.camera.up = {0, 0, 1};
        view.camera.fov = 45;
        view.quality.samples = 1;
        const auto frame = render(device, cloud, view);
        if (!frame) return clicks;
        int made = 0;
        for (std::uint64_t i = 0; made < perPicture && i < std::uint64_t(perPicture) * 10; ++i) {
            const glm::ivec2 pixel(int(1280 * uniform(i, 11 + 2 * std::uint64_t(k))),
                                   int(720 * uniform(i, 12 + 2 * std::uint64_t(k))));
            const double depth = frame->depth[std::size_t(pixel.y) * 1280 + std::size_t(pixel.x)];
            const auto at = placeUnder(cloud, view, pixel, 1);
            if (!std::isfinite(depth) || !at) continue;
            const auto hit =
                town.cast({view.camera.eye, glm::normalize(cloud.origin + *at - view.camera.eye)}, 0, 300);
            if (!hit || (hit->classification >= 3 && hit->classification <= 5)) continue;
            const auto picked = pick(cloud, view, pixel, depth);
            if (!picked || !*picked) continue;
            clicks.push_back({hit->position, (*picked)->point.position, (*picked)->surface});
            ++made;
        }
    }
    return clicks;
}

}  // namespace scancast::test
