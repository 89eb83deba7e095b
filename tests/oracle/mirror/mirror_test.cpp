// Mirrors against geometry: a room with a mirror must look like the room and its mirror image, built as
// points behind the glass, because that is what a mirror is.
#include <gtest/gtest.h>

#include "tests/oracle/mirror/draw_mirrored.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/picture_metrics.hpp"

namespace scancast {
namespace {

using namespace test;

/// The glass takes some of the light that comes through it, from whatever stands behind its plane.
void tint(const MirroredRoom& room, const GlassPixels& glass, Frame& frame) {
    std::vector<std::uint8_t>& rgba = frame.rgba.own();
    for (std::size_t i = 0; i < glass.mask.size(); ++i) {
        if (!glass.mask[i] || frame.depth[i] < glass.depth[i] - 2 * room.spacing) continue;
        for (std::size_t c = 0; c < 3; ++c)
            rgba[4 * i + c] =
                static_cast<std::uint8_t>(std::lround(rgba[4 * i + c] * room.mirror.tint[c] / 255.0));
    }
}

/// Without surfels' and sprites' extent: what pixel a point falls into is all that counts.
bool drawsPixels(const Method& method) {
    return method.name == "point" || method.name == "pyramid";
}

/// Pixels inside the frame from which on pictures must be the same. What `pyramid` puts into a hole it takes
/// from around it, and in the room built twice the image goes on behind the holes in the wall.
int trustedFrom(const Method& method) {
    return method.name == "pyramid" ? 8 : 2;
}

void compareWithGeometry(const MirroredRoom& room, Device& device, bool few, bool pixels,
                         double leastOfDiscs = 45) {
    const AnalyticCloud once(room.points, room.spacing);
    const AnalyticCloud images(room.images(), room.spacing);
    const Cut twice = once.joined(images);
    for (const Method& method : methods()) {
        if (drawsPixels(method) != pixels) continue;
        for (const Setting& setting : settings(room, few)) {
            MethodScene mirrored(room, method, setting.view, once.cut());
            const auto reflections = reflectionsFor(room, setting.view, once.cut());
            ASSERT_EQ(reflections.size(), 1u);
            mirrored.drawing.add(reflections);
            const Frame picture = mustDraw(device, mirrored.drawing);
            const MethodScene built(room, method, setting.view, twice);
            Frame truth = mustDraw(device, built.drawing);
            const GlassPixels glass = glassOf(room.mirror, setting.view);
            tint(room, glass, truth);
            const PixelMask inside =
                eroded(glass.mask, setting.view.width, setting.view.height, trustedFrom(method));
            const double similar = psnr(picture, truth, inside).value();
            EXPECT_GE(similar, method.name == "disc" ? leastOfDiscs : 45)
                << "in the glass, " << method.name
                << " differs from the room built twice (docs/spec/mirrors.md), " << setting.name;
        }
    }
}

class MirrorOracle : public OnDevice {};
SCANCAST_ON_DEVICES(MirrorOracle, "egl");

TEST_P(MirrorOracle, ARoomLooksLikeTheRoomBuiltTwice) {
    compareWithGeometry(MirroredRoom(0.02, 0.06), *device_, slow_, false);
}

TEST_P(MirrorOracle, ARoomOfPixelsToo) {
    compareWithGeometry(MirroredRoom(0.008, 0), *device_, slow_, true);
}

// Here normals are rounded to other codes than their images': which of two discs is nearer may change.
TEST_P(MirrorOracle, ATurnedRoomToo) {
    glm::dmat4 placed = glm::translate(glm::dmat4(1), {3, -7, 2});
    placed = glm::rotate(placed, 0.6, glm::normalize(glm::dvec3(0.2, 0.1, 1)));
    compareWithGeometry(MirroredRoom(0.02, 0.06, placed), *device_, slow_, false, 35);
}

}  // namespace
}  // namespace scancast
