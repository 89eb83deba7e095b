#include <algorithm>
#include <array>

#include "simulator/scene.hpp"

namespace scancast {
namespace {

constexpr std::array views{
    SceneView{"town", "roofs", {-60, -75, 42}, {5, 5, 2}, 50},
    SceneView{"town", "square", {-19, -24, 7.5}, {2, 8, 4.5}, 60},
    SceneView{"town", "street", {25.3, -58, 1.8}, {25, -10, 3}, 60},
    SceneView{"room", "mirror", {-1.7, -1.8, 1.6}, {0.5, 1.5, 1.2}, 70},
    SceneView{"room", "table", {1.6, -1.5, 1.5}, {0.1, 0, 0.85}, 45},
    SceneView{"sphere", "side", {2.2, -2.6, 1.4}, {0, 0, 0}, 40},
    SceneView{"plane", "slanted", {-0.6, -2.4, 1.5}, {0, 0, 0}, 45},
    SceneView{"plane", "grazing", {0, -2.2, 0.25}, {0, 0.2, 0}, 40},
    SceneView{"statue", "whole", {-1.2, -4.9, 2.1}, {0, 0, 1.55}, 40},
    SceneView{"statue", "head", {-0.45, -0.95, 2.95}, {0, 0, 2.87}, 25},
    SceneView{"statue", "drapery", {-0.8, -1.5, 2.0}, {0, 0, 1.85}, 35},
    SceneView{"statue", "inscription", {0.25, -1.6, 0.85}, {0, -0.34, 0.63}, 32},
    SceneView{"cube", "corner", {3.2, -4.2, 2.6}, {0, 0, 0}, 36},
    SceneView{"cube", "crease", {1.9, -1.9, 0.5}, {1, -1, 0.2}, 40},
    SceneView{"torus", "above", {1.6, -3.2, 2.0}, {0, 0, 0}, 46},
    SceneView{"torus", "through", {2.3, -1.7, 0.25}, {-0.3, 0.2, 0}, 46},
    SceneView{"sign", "facing", {0, -2.7, 0.8}, {0, 0, 0.8}, 36},
    SceneView{"sign", "slanted", {-2.2, -1.6, 1.0}, {0, 0, 0.8}, 40},
    SceneView{"bridge", "river", {-16, -30, 5}, {2, 0, 3}, 50},
    SceneView{"bridge", "under", {-13.2, -2.2, 3.4}, {10, 0.5, 3.0}, 60},
    SceneView{"bridge", "opening", {6.5, -1.6, 9.5}, {5.6, 0.6, 0.5}, 60},
};

}  // namespace

std::span<const SceneView> sceneViews(std::string_view scene) {
    const auto same = [&](const SceneView& view) { return view.scene == scene; };
    const auto* first = std::ranges::find_if(views, same);
    const auto* last = std::find_if_not(first, views.end(), same);
    return {first, last};
}

}  // namespace scancast
