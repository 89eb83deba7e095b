// Looks that use every field.
#pragma once

#include <glm/geometric.hpp>

#include "protocol/look.hpp"
#include "tests/unit/protocol/sample_views.hpp"

namespace scancast::test {

/// Numbers that only read back if every digit is there.
inline Look richLook() {
    Look look;
    look.kind = SceneKind::Street;
    look.reason = "A ground with upright things on it: \"Straße\".";
    look.up = {0, -1, 0};
    look.bounds = {glm::dvec3(-1.0 / 3, -2e9, 0.1 + 0.2), glm::dvec3(1.0 / 3, 5411987.0625, 0.7)};
    look.outline = {{0, 1e-300, 444123.125}, {1.0 / 7, -3, 2}, {5, 5, 5}};
    look.noise = 1.0 / 300;
    look.style = richView().style;
    look.views = {{"from the scanner", true, richView().camera},
                  {"top", false, orthographicView().camera},
                  {"as it was drawn", false, matrixView().camera}};
    return look;
}

/// As little as a cloud can be shown by.
inline Look plainLook() {
    Look look;
    look.outline = {{1, 2, 3}};
    look.views = {{"whole", false, Camera{}}};
    return look;
}

}  // namespace scancast::test
