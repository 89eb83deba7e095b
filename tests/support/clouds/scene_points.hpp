// Points of simulated scenes in memory, and the room with a mirror built twice: as it is, and with its mirror
// image as geometry behind the glass. Drawing the second is the oracle for drawing the first with mirrors.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>

#include "simulator/cells.hpp"
#include "simulator/scene.hpp"
#include "tests/support/clouds/read_all.hpp"

namespace scancast::test {

/// All points of a scene. Throws when the scene cannot be made.
inline PointBatch scenePoints(const SceneOptions& options) {
    return readAll(*simulate(options).value()).value();
}

inline void appendPoint(PointBatch& to, const PointBatch& from, std::size_t i) {
    forColumns(to, from, [i](auto& column, const auto& values) {
        if (!values.empty()) column.push_back(values[i]);
    });
}

/// What stands before the mirror: without the points that the scanner saw in it. Noise may put points of the
/// wall `slack` metres behind the glass.
inline PointBatch beforeMirror(const PointBatch& points, const Mirror& mirror, double slack = 0.01) {
    PointBatch kept;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (glm::dot(points.position[i] - mirror.center, mirror.normal) > -slack)
            appendPoint(kept, points, i);
    return kept;
}

/// The mirror's image of all points more than `slack` metres before it: positions and normals reflected,
/// colours tinted as the glass does. What lies nearer is the wall itself, which would be its own image.
inline PointBatch reflections(const PointBatch& points, const Mirror& mirror, double slack = 0.01) {
    PointBatch images;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (glm::dot(points.position[i] - mirror.center, mirror.normal) <= slack) continue;
        appendPoint(images, points, i);
        glm::dvec3& at = images.position.doubles().back();
        at = reflected(mirror, at);
        glm::vec3& normal = images.normal.back();
        const glm::vec3 glass(mirror.normal);
        normal -= glass * (2 * glm::dot(normal, glass));
        for (std::size_t c = 0; c < 3; ++c)
            images.color.back()[c] =
                std::uint8_t(std::lround(images.color.back()[c] * mirror.tint[c] / 255.0));
    }
    return images;
}

struct BuiltTwice {
    Mirror mirror;
    PointBatch once;   ///< the scene before its mirror
    PointBatch twice;  ///< the same points, then their images
};

/// For scenes with a mirror: "room".
inline BuiltTwice builtTwice(const SceneOptions& options) {
    BuiltTwice scene;
    scene.mirror = sceneMirrors(options).at(0);
    scene.once = beforeMirror(scenePoints(options), scene.mirror);
    scene.twice = scene.once;
    const PointBatch images = reflections(scene.once, scene.mirror);
    for (std::size_t i = 0; i < images.size(); ++i) appendPoint(scene.twice, images, i);
    return scene;
}

/// Points in memory as a source, so that clouds can be built of them.
class BatchSource final : public PointSource {
  public:
    explicit BatchSource(PointBatch points) : points_(std::move(points)) {
        header_.format = "points in memory";
        header_.points = points_.size();
        header_.attributes = {!points_.color.empty(), !points_.intensity.empty(),
                              !points_.classification.empty(), !points_.normal.empty()};
    }
    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }
    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        const std::size_t end = std::min(points_.size(), next_ + batchPoints);
        forColumns(batch, points_, [&](auto& to, const auto& from) {
            if (!from.empty())
                to.assign(from.begin() + std::ptrdiff_t(next_), from.begin() + std::ptrdiff_t(end));
        });
        next_ = end;
        return batch.size() > 0;
    }

  private:
    PointBatch points_;
    ScanHeader header_;
    std::size_t next_ = 0;
};

}  // namespace scancast::test
