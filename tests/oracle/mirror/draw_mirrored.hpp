// Draws the room with its mirror by any method, as the front door would, and finds the glass on the picture.
#pragma once

#include <gtest/gtest.h>

#include "renderer/method/method.hpp"
#include "renderer/mirrors.hpp"
#include "tests/oracle/mirror/mirrored_room.hpp"
#include "tests/support/pictures/draw_cut.hpp"
#include "tests/support/pictures/picture_metrics.hpp"

namespace scancast::test {

/// Of a mirror, seen from a viewpoint: which pixels, and at what depth. Ray by ray in double.
struct GlassPixels {
    PixelMask mask;
    std::vector<double> depth;
};

inline GlassPixels glassOf(const Mirror& mirror, const Viewpoint& v) {
    GlassPixels glass;
    const glm::dmat4 toCloud = glm::inverse(v.cloudToView);
    const glm::dvec3 right = glm::cross(mirror.up, mirror.normal);
    const bool perspective = v.projection == Projection::Perspective;
    for (int y = 0; y < v.height; ++y) {
        for (int x = 0; x < v.width; ++x) {
            const double u = (x + 0.5 - v.width * 0.5) / v.pixelsPerUnit;
            const double w = (v.height * 0.5 - y - 0.5) / v.pixelsPerUnit;
            const glm::dvec3 from(toCloud * (perspective ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(u, w, 0, 1)));
            const glm::dvec3 ray(toCloud * (perspective ? glm::dvec4(u, w, -1, 0) : glm::dvec4(0, 0, -1, 0)));
            const double t = glm::dot(mirror.center - from, mirror.normal) / glm::dot(ray, mirror.normal);
            const glm::dvec3 at = from + ray * t - mirror.center;
            glass.mask.push_back(t > 0 && std::abs(glm::dot(at, right)) < mirror.width / 2 &&
                                 std::abs(glm::dot(at, mirror.up)) < mirror.height / 2);
            glass.depth.push_back(t);
        }
    }
    return glass;
}

/// As far as any method's screen passes look.
inline constexpr int screenMargin = 128;

struct Setting {
    const char* name;
    Viewpoint view;
};

/// `few`: one of each projection, for devices that are slow and are held against the cpu device, mirrors and
/// all, byte by byte elsewhere (tests/oracle/gl/render_agreement_test.cpp).
inline std::vector<Setting> settings(const MirroredRoom& room, bool few = false) {
    const auto at = [&](double x, double y, double z) { return room.at({x, y, z}); };
    std::vector<Setting> all{
        {"from the back", lookAt(at(-1.2, -1.5, 1.5), at(0.2, 2, 1.3), 640, 480)},
        {"near", lookAt(at(0.6, 0.7, 1.5), at(0.1, 2, 1.3), 480, 480)},
        {"at a slant", lookAt(at(-1.6, 1.2, 1.0), at(0.2, 2, 1.3), 480, 360)},
        {"parallel", lookAtOrthographic(at(1, -1.5, 1.8), at(0.2, 2, 1.3), 480, 360, 2)},
    };
    if (few) all.erase(all.begin(), all.end() - 2);
    return all;
}

/// What draw() of renderer/render.cpp does, for a cut known exactly.
struct MethodScene {
    PassList passes;
    OwnDrawing drawing;
    MethodScene(const MirroredRoom& room, const Method& method, const Viewpoint& view, const Cut& cut)
        : drawing(view, cut, {}) {
        const auto values = resolveParameters(method, {}).value();
        const CloudTraits traits{true, true, true, true, room.spacing};
        passes = method.passes({method, values, method.defaultShading, traits, method.defaultDetail});
        drawing.passes = passes;
        drawing.surfels = drawing.oriented = true;
        drawing.background.kind = Background::Kind::Color;
        drawing.background.top = {0, 0, 0};  // glass tints it, points behind do not
    }
    MethodScene(const MethodScene&) = delete;
};

/// Only what mirrors need to know of a cloud.
inline Cloud cloudOf(const MirroredRoom& room) {
    Cloud cloud;
    cloud.mirrors = {room.mirror};
    cloud.spacing = room.spacing;
    return cloud;
}

inline std::vector<CutView> reflectionsFor(const MirroredRoom& room, const Viewpoint& view, const Cut& cut) {
    auto reflections = reflectionsIn(cloudOf(room), view, {}, screenMargin);
    for (CutView& r : reflections) r.cut = cut;
    return reflections;
}

}  // namespace scancast::test
