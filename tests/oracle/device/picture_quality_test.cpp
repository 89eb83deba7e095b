// What the method is for: lettering on a scanned sign stays readable. The sign is a texture that the test
// knows.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/pictures/devices.hpp"
#include "tests/support/pictures/draw_cut.hpp"

namespace scancast::test {
namespace {

class PictureQuality : public OnDevice {};
SCANCAST_ON_DEVICES(PictureQuality, "egl");

/// Black strokes of about 1/12 unit on white, at every angle: rings and spokes.
double ink(double x, double z) {
    const double r = std::hypot(x, z), angle = std::atan2(z, x);
    return std::sin(r * 38) > 0.2 || std::sin(angle * 14) > 0.9 ? 255 : 0;
}

struct Sign {
    Viewpoint view = lookAt({0, 0, 0}, {0.35, 1, 0.1}, 400, 300, 40);
    std::vector<AnalyticPoint> points;

    /// A scan of the plane y = 3 with `apart` px between samples, with range noise of a third of that.
    explicit Sign(double apart) {
        Numbers numbers(41);
        const double step = apart / view.q(3);
        for (double x = -1.2; x < 3.6; x += step) {
            for (double z = -1.4; z < 2.0; z += step) {
                AnalyticPoint p;
                p.position = {x + numbers.uniform(-0.4, 0.4) * step, 3 + numbers.uniform(-0.3, 0.3) * step,
                              z + numbers.uniform(-0.4, 0.4) * step};
                const auto v = static_cast<std::uint8_t>(ink(p.position.x, p.position.z));
                p.rgb = {v, v, v};
                points.push_back(p);
            }
        }
    }

    /// The texture where the ray through (px, py) meets the sign, averaged over the pixel.
    double truth(int px, int py) const {
        double sum = 0;
        const glm::dmat3 toWorld = glm::transpose(glm::dmat3(view.cloudToView));
        for (int i = 0; i < 16; ++i) {
            const double x = px + (i % 4 + 0.5) / 4, y = py + (i / 4 + 0.5) / 4;
            const glm::dvec3 ray =
                toWorld * glm::dvec3(x - view.width / 2.0, view.height / 2.0 - y, -view.pixelsPerUnit);
            const glm::dvec3 hit = ray * (3 / ray.y);
            sum += ink(hit.x, hit.z) / 16;
        }
        return sum;
    }
};

double psnr(Device& device, const Sign& sign, const AnalyticCloud& cloud, const NearestPass& pass) {
    Scene scene(sign.view, cloud.cut(), pass);
    const Frame frame = mustDraw(device, scene.drawing);
    double sum = 0;
    int n = 0;
    for (int y = 30; y < 270; ++y) {
        for (int x = 30; x < 370; ++x, ++n) sum += std::pow(pixel(frame, x, y)[0] - sign.truth(x, y), 2);
    }
    return 10 * std::log10(255.0 * 255.0 * n / sum);
}

TEST_P(PictureQuality, ParaboloidsShowASignBetterThanCirclesAndSquares) {
    // Right because the sign is known: the picture nearer to it, by squared error, is the better one.
    for (const double apart : {2.0, 3.0, 4.0}) {
        const Sign sign(apart);
        const AnalyticCloud cloud(sign.points, 0.01);
        const float px = static_cast<float>(2.2 * apart);
        const double paraboloid =
            psnr(*device_, sign, cloud, sprite(Footprint::Circle, Profile::Paraboloid, px));
        EXPECT_GT(paraboloid, psnr(*device_, sign, cloud, sprite(Footprint::Circle, Profile::Flat, px)))
            << apart;
        EXPECT_GT(paraboloid, psnr(*device_, sign, cloud, sprite(Footprint::Square, Profile::Flat, px)))
            << apart;
    }
}

TEST_P(PictureQuality, AveragedFramesComeNearerToTheTruth) {
    // Right because the truth is an average over the pixel's area, and so are the frames, shifted within the
    // pixel.
    const Sign sign(1.5);
    const AnalyticCloud cloud(sign.points, 0.01);
    const NearestPass pass = sprite(Footprint::Circle, Profile::Paraboloid, 4);
    const double one = psnr(*device_, sign, cloud, pass);
    Scene scene(sign.view, cloud.cut(), pass);
    const glm::dvec2 jitter[] = {{0, -1 / 6.0}, {-0.25, 1 / 6.0}, {0.25, -7 / 18.0}, {-0.375, -1 / 18.0}};
    scene.drawing.jitter = jitter;
    const Frame frame = mustDraw(*device_, scene.drawing);
    double sum = 0;
    int n = 0;
    for (int y = 30; y < 270; ++y) {
        for (int x = 30; x < 370; ++x, ++n) sum += std::pow(pixel(frame, x, y)[0] - sign.truth(x, y), 2);
    }
    EXPECT_GT(10 * std::log10(255.0 * 255.0 * n / sum), one + 1);
}

}  // namespace
}  // namespace scancast::test
