// Generated scenes as clouds with levels of detail and surfels, and their views in either projection: what
// devices are compared on through the front door.
#pragma once

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <string>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/render.hpp"
#include "simulator/scene.hpp"

namespace scancast::test {

/// Leaves of at most `leafPoints`: the fewer, the more levels even a small cloud has.
inline Expected<std::shared_ptr<const Cloud>> sceneCloud(const std::string& scene, std::uint64_t points,
                                                         std::uint32_t leafPoints = 2048, bool surfels = true,
                                                         const ProgressSink& progress = {}) {
    SceneOptions options;
    options.scene = scene;
    options.points = points;
    options.origin = glm::dvec3(0);
    auto source = simulate(options);
    if (!source) return passOn(source);
    BuildOptions build;
    build.shape.leafPoints = leafPoints;
    build.shape.surfels = surfels;
    build.mirrors = sceneMirrors(options);
    return buildCloud(**source, build, progress);
}

inline Camera cameraOf(const SceneView& from) {
    Camera camera;
    camera.eye = from.eye;
    camera.target = from.target;
    camera.fov = from.fov;
    return camera;
}

/// One of the scene's own views; without perspective it shows as much at its target.
inline View sceneView(const Cloud& cloud, const SceneView& from, Projection projection, int width,
                      int height) {
    View view = defaultView(cloud, width, height);
    view.camera = cameraOf(from);
    view.camera.projection = projection;
    view.camera.viewHeight = 2 * glm::distance(from.eye, from.target) * std::tan(glm::radians(from.fov) / 2);
    view.style.color = ColorSource::Rgb;
    view.quality.samples = 1;
    return view;
}

}  // namespace scancast::test
