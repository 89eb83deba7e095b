// The sun's shadows (docs/spec/shading.md §10): where geometry says that they fall, and pixel by pixel against the formula in
// double, looked up in what the sun sees.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "renderer/method/light.hpp"
#include "renderer/sun.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {
namespace {

class Shadow : public OnDevice {};
SCANCAST_ON_DEVICES(Shadow, "egl");

constexpr double spacing = 0.025;
constexpr float bias = 0.1f;
const glm::dvec3 up(0, 0, 1);

/// Ground at z = 0, from -3 to 3, and a plate at z = 1, from -0.8 to 0.8.
AnalyticCloud plateOverGround() {
    std::vector<AnalyticPoint> points;
    const auto add = [&](double x, double y, double z) {
        AnalyticPoint p;
        p.position = {x, y, z};
        p.rgb = {240, 160, 80};
        p.normal = encodeNormal(glm::vec3(up));
        points.push_back(p);
    };
    for (double x = -3; x <= 3; x += spacing) {
        for (double y = -3; y <= 3; y += spacing) {
            add(x, y, 0);
            if (std::abs(x) <= 0.8 && std::abs(y) <= 0.8) add(x, y, 1);
        }
    }
    return {points, spacing};
}

const std::array<glm::dvec3, 2> bounds{glm::dvec3(-3, -3, 0), glm::dvec3(3, 3, 1)};

std::vector<Viewpoint> pictures() {
    return {lookAt({0.5, -6, 4}, {0, 0, 0.3}, 240, 180),
            lookAtOrthographic({0.5, -6, 4}, {0, 0, 0.3}, 240, 180, 6)};
}

/// What stands at a pixel, cloud-relative.
glm::dvec3 placeOf(const Frame& frame, const Viewpoint& view, int x, int y) {
    const double d = depth(frame, x, y);
    const double scale = (view.projection == Projection::Perspective ? d : 1) / view.pixelsPerUnit;
    const glm::dvec3 place((x + 0.5 - view.width / 2.0) * scale, (view.height / 2.0 - y - 0.5) * scale, -d);
    return {glm::inverse(view.cloudToView) * glm::dvec4(place, 1)};
}

struct Sunny : Scene {
    CutView sun;

    Sunny(const Viewpoint& view, const AnalyticCloud& cloud, const glm::dvec3& way)
        : Scene(view, cloud.cut(), bySample()),
          sun{sunViewpoint(bounds, view, way).value(), cloud.cut(), {}} {
        passes = {bySample(), ResolvePass{false, true}};
        drawing.passes = passes;
        drawing.sun = &sun;
    }

  private:
    static NearestPass bySample() {
        NearestPass nearest = sprite(Footprint::Square, Profile::Flat, 5);
        nearest.payload = Payload::Sample;
        return nearest;
    }
};

/// Of the ground, how far inside the plate's shadow; negative: outside.
double insideShadow(const glm::dvec3& ground, const glm::dvec3& way) {
    const glm::dvec3 above = ground + way / way.z;
    return 0.8 - std::max(std::abs(above.x), std::abs(above.y));
}

TEST_P(Shadow, FallsWhereGeometrySays) {
    // Right because the sun's ray from a point on the ground meets the plate's plane in one point: inside it or not.
    const AnalyticCloud cloud = plateOverGround();
    const glm::dvec3 way = wayToSun({100, 50}, up);
    for (const Viewpoint& view : pictures()) {
        Sunny plain(view, cloud, way), scene(view, cloud, way);
        scene.add(ShadowPass{0.9f, 0.5f, bias});
        const Frame unlit = mustDraw(*device_, plain.drawing), frame = mustDraw(*device_, scene.drawing);
        ASSERT_EQ(frame.depth, unlit.depth);
        int dark = 0, light = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                if (std::isinf(depth(frame, x, y))) continue;
                const glm::dvec3 place = placeOf(frame, view, x, y);
                const double inside = place.z > 0.8 ? -1 : insideShadow(place, way);
                if (inside > 0.15) {
                    ASSERT_EQ(pixel(frame, x, y), (Rgb8{132, 88, 44})) << x << ", " << y << ": 1 - 0.5 · 0.9";
                    ++dark;
                } else if (inside < -0.15) {
                    ASSERT_EQ(pixel(frame, x, y), pixel(unlit, x, y)) << x << ", " << y;
                    ++light;
                }
            }
        }
        EXPECT_GT(dark, 300);
        EXPECT_GT(light, 5000);
    }
}

TEST_P(Shadow, TakesTheSunFromPhong) {
    // Right because what the sun does not see is lit as if there were none.
    const AnalyticCloud cloud = plateOverGround();
    const glm::dvec3 way = wayToSun({100, 50}, up);
    PhongPass lit{0.3f, 0.2f, 0.6f, 0.1f};
    for (std::size_t axis = 0; axis < 3; ++axis) lit.sun[axis] = float(way[int(axis)]);
    PhongPass dark = lit, shadowed = lit;
    dark.sunlight = 0;
    shadowed.shadows = true;
    const Viewpoint view = pictures()[0];
    Sunny sunny(view, cloud, way), clouded(view, cloud, way), scene(view, cloud, way),
        lonely(view, cloud, way);
    sunny.add(lit);
    clouded.add(dark);
    for (Sunny* const s : {&scene, &lonely}) {
        s->add(ShadowPass{1, 0, bias});
        s->add(shadowed);
    }
    lonely.drawing.sun = nullptr;
    const Frame light = mustDraw(*device_, sunny.drawing), shade = mustDraw(*device_, clouded.drawing);
    const Frame frame = mustDraw(*device_, scene.drawing);
    EXPECT_EQ(mustDraw(*device_, lonely.drawing).rgba, light.rgba)
        << "without a map nothing is in the shadow";
    for (int y = 0; y < frame.height; ++y) {
        for (int x = 0; x < frame.width; ++x) {
            if (std::isinf(depth(frame, x, y))) continue;
            const glm::dvec3 place = placeOf(frame, view, x, y);
            const double inside = place.z > 0.8 ? -1 : insideShadow(place, way);
            if (std::abs(inside) < 0.15) continue;
            ASSERT_EQ(pixel(frame, x, y), pixel(inside > 0 ? shade : light, x, y)) << x << ", " << y;
        }
    }
}

TEST_P(Shadow, FollowsItsFormula) {
    // Right because the map is drawn once more, as a picture of its own, and looked up in double.
    const AnalyticCloud cloud = plateOverGround();
    const glm::dvec3 way = wayToSun({-160, 35}, up);
    for (const Viewpoint& view : pictures()) {
        Sunny scene(view, cloud, way);
        scene.add(ShadowPass{1, 1, bias});
        const Frame frame = mustDraw(*device_, scene.drawing);
        const Viewpoint& sun = scene.sun.viewpoint;
        NearestPass circles;
        circles.profile = Profile::Flat;
        circles.gain = 0;
        Scene ofSun(sun, cloud.cut(), circles);
        const Frame map = mustDraw(*device_, ofSun.drawing);
        int compared = 0, differing = 0;
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                if (std::isinf(depth(frame, x, y))) continue;
                const glm::dvec3 place(sun.cloudToView * glm::dvec4(placeOf(frame, view, x, y), 1));
                const double u = sun.width / 2.0 + place.x * sun.pixelsPerUnit;
                const double v = sun.height / 2.0 - place.y * sun.pixelsPerUnit;
                const int column = int(std::floor(u)), row = int(std::floor(v));
                const bool inMap = u >= 1 && v >= 1 && u < sun.width - 1 && v < sun.height - 1;
                const double right = (u - column) / 2, below = (v - row) / 2;
                double seen = inMap ? 0 : 1;
                for (const int j : {-1, 0, 1}) {
                    for (const int i : {-1, 0, 1}) {
                        if (!inMap) continue;
                        const double weight = (i < 0   ? 0.5 - right
                                               : i > 0 ? right
                                                       : 0.5) *
                                              (j < 0   ? 0.5 - below
                                               : j > 0 ? below
                                                       : 0.5);
                        if (depth(map, column + i, row + j) >= -place.z - bias) seen += weight;
                    }
                }
                ++compared;
                differing += std::abs(pixel(frame, x, y)[0] - 240 * seen) > 1.1 ? 1 : 0;
            }
        }
        EXPECT_GT(compared, 10'000);
        // Where float and double round a place to different texels, or a depth to different sides of the limit.
        EXPECT_LE(differing, compared / 500);
    }
}

}  // namespace
}  // namespace scancast::test
