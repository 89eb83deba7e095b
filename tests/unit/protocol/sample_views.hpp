// Views that differ from the default in every field that has another value to take.
#pragma once

#include <vector>

#include "protocol/view/view.hpp"

namespace scancast::test {

inline View richView() {
    View view;
    view.camera.eye = {444123.125, 5411987.0625, 0.1};
    view.camera.target = {444000, 5412000, 1.0 / 3.0};
    view.camera.up = {0, 0.1, 0.9};
    view.camera.fov = 33.3;
    view.camera.near = 0.001;
    view.camera.far = 1e5;
    view.width = 1919;
    view.height = 1079;
    view.style.method = "cone";
    view.style.parameters = {{"sizePx", 5.5}, {"smooth", true}, {"footprint", std::string("square")}};
    view.style.color = ColorSource::Classification;
    view.style.byIntensity = true;
    view.style.exposure = -1.25;
    view.style.colormap = "grey";
    view.style.range = {-1.5, 20};
    view.style.classes = {{2, 6, 255}};
    view.style.filter = {{"gps_time", 0.1, 3600}, {"odd; 100 %: a", {}, -1e-5}, {"intensity", 1.0 / 3.0, {}}};
    view.style.clip = ClipBox{{0, 1, 2}, {3, 4, 5}};
    view.style.clips = {TurnedBox{{444120.5, 5411990, 0.1}, {1.0 / 3.0, 2, 3}, {12.5, -3, 180}, true},
                        HalfSpace{{444120, 5411990, 2}, {0.5, 0, -0.1}}, TurnedBox{{1, 2, 3}, {4, 5, 6}}};
    view.style.shading = Shading::Phong;
    view.style.light = {.ambient = 0.25,
                        .headlight = 0.125,
                        .sun = {{225.5, 30}},
                        .sunlight = 1,
                        .shine = 0,
                        .occlusion = 0.5,
                        .shadow = 1};
    view.style.mirrors = false;
    view.style.behindMirrors = true;
    view.style.outliers = Outliers::Show;
    view.style.background = {Background::Kind::Color, {1, 2, 3}, Background{}.bottom};
    view.with = {{"town-2024", {0.1, -2, 1.0 / 3.0}, Rgb8{1, 128, 255}, false}, {".", {}, {}, true}, {"a b", {}, {}, false}};
    view.quality.detail = 0.5;
    view.quality.budget = 18446744073709551615u;
    view.quality.samples = 16;
    view.quality.jpegQuality = 77;
    view.quality.subsampling = Subsampling::S444;
    return view;
}

inline View orthographicView() {
    View view;
    view.camera.projection = Projection::Orthographic;
    view.camera.viewHeight = 12.75;
    view.style.color = ColorSource::Flat;
    view.style.flatColor = {255, 136, 0};
    view.style.background.kind = Background::Kind::Transparent;
    return view;
}

inline View matrixView() {
    View view;
    view.camera.viewMatrix = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0.25, 0, -10, 1};
    return view;
}

inline std::vector<View> sampleViews() {
    return {View{}, richView(), orthographicView(), matrixView()};
}

}  // namespace scancast::test
