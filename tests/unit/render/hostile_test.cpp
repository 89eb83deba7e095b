// Views and clouds that nobody sane asks for, in every method: each gets a refusal that says why, or a
// picture whose every pixel is a colour and whose every depth is positive. That it comes back at all is half
// of the test.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/method/method.hpp"
#include "renderer/render.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

using Make = test::SyntheticSource::Make;

std::shared_ptr<const Cloud> built(std::uint64_t count, const Make& make) {
    Attributes attributes;
    attributes.color = true;
    test::SyntheticSource source(count, make, attributes, 0);
    BuildOptions options;
    options.shape.surfels = true;
    options.threads = 2;
    auto cloud = buildCloud(source, options);
    if (!cloud) throw std::runtime_error(cloud.error().message);
    return *cloud;
}

/// A patch of ground, one unit across, around (1000, 2000, 30).
test::ScanPoint ground(std::uint64_t i, std::uint64_t) {
    test::ScanPoint p;
    p.position = {1000 + test::uniform(i, 1), 2000 + test::uniform(i, 2), 30 + 0.01 * test::uniform(i, 3)};
    p.color = {static_cast<std::uint8_t>(i), 100, 200};
    return p;
}

struct NamedCloud {
    const char* name;
    std::shared_ptr<const Cloud> cloud;
};

const std::vector<NamedCloud>& clouds() {
    static const std::vector<NamedCloud> all = {
        {"ordinary", built(3000, ground)},
        {"one point", built(1, ground)},
        {"two points", built(2, ground)},
        {"all points equal", built(3000, [](auto, auto n) { return ground(0, n); })},
        {"a line", built(3000,
                         [](auto i, auto n) {
                             auto p = ground(0, n);
                             p.position.x += 1e-3 * double(i);
                             return p;
                         })},
        {"a far outlier", built(3000,
                                [](auto i, auto n) {
                                    auto p = ground(i, n);
                                    if (i == 7) p.position *= 1e4;
                                    return p;
                                })},
    };
    return all;
}

void expectSane(const Frame& frame) {
    ASSERT_EQ(frame.rgba.size(), static_cast<std::size_t>(frame.width) * frame.height * 4);
    for (const float d : frame.depth) ASSERT_TRUE(d > 0) << d;
    for (std::size_t i = 3; i < frame.rgba.size(); i += 4) ASSERT_EQ(frame.rgba[i], 255);
}

class HostileViews : public testing::TestWithParam<const Method*> {
  protected:
    View view(const Cloud& cloud) const {
        View v = defaultView(cloud, 96, 64);
        v.style.method = GetParam()->name;
        v.quality.samples = 1;
        return v;
    }
    void expectPictureOrReason(const Cloud& cloud, const View& v) {
        const auto frame = render(*device_, cloud, v);
        if (frame) return expectSane(*frame);
        EXPECT_FALSE(frame.error().message.empty());
        EXPECT_NE(frame.error().code, ErrorCode::Internal) << frame.error().message;
    }
    /// Some views are refused, always.
    void expectReason(const Cloud& cloud, const View& v) {
        const auto frame = render(*device_, cloud, v);
        ASSERT_FALSE(frame);
        EXPECT_FALSE(frame.error().message.empty());
    }
    std::unique_ptr<Device> device_ = createDevice({"cpu", 2, -1}).value();
};

TEST_P(HostileViews, OfEveryCloudFromItsDefaultPlace) {
    for (const NamedCloud& c : clouds()) {
        SCOPED_TRACE(c.name);
        for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
            for (const Shading shading : {Shading::Unlit, Shading::Phong, Shading::EyeDome}) {
                View v = view(*c.cloud);
                v.camera.projection = projection;
                v.style.shading = shading;
                expectPictureOrReason(*c.cloud, v);
            }
        }
    }
}

TEST_P(HostileViews, CamerasInsideAndFarAway) {
    for (const NamedCloud& c : clouds()) {
        SCOPED_TRACE(c.name);
        const glm::dvec3 point(1000 + test::uniform(0, 1), 2000 + test::uniform(0, 2),
                               30 + 0.01 * test::uniform(0, 3));
        for (const glm::dvec3& eye :
             {point, point + glm::dvec3(1e-9, 0, 0), point + glm::dvec3(0, 0, 1e-4),
              point + glm::dvec3(1e6, 0, 0), point + glm::dvec3(0, -1e12, 5), glm::dvec3(1e300, 0, 0)}) {
            View v = view(*c.cloud);
            v.camera.eye = eye;
            v.camera.target = point + glm::dvec3(0.3, 0.2, 0);
            expectPictureOrReason(*c.cloud, v);
            v.camera.projection = Projection::Orthographic;
            v.camera.viewHeight = 1e-6;
            expectPictureOrReason(*c.cloud, v);
            v.camera.viewHeight = 1e12;
            expectPictureOrReason(*c.cloud, v);
        }
    }
}

TEST_P(HostileViews, AnglesSizesAndDetail) {
    const Cloud& cloud = *clouds()[0].cloud;
    for (const double fov : {1e-6, 1.0, 179.0, 179.99999}) {
        View v = view(cloud);
        v.camera.fov = fov;
        expectPictureOrReason(cloud, v);
    }
    for (const double detail : {0.0, 1e-9, 1e9}) {
        View v = view(cloud);
        v.quality.detail = detail;
        expectPictureOrReason(cloud, v);
    }
    for (const int side : {1, 2, 7}) {
        View v = view(cloud);
        v.width = side;
        v.height = 8 - side;
        expectPictureOrReason(cloud, v);
    }
    View v = view(cloud);
    v.camera.near = 1e-30;
    v.camera.far = 1e300;
    expectPictureOrReason(cloud, v);
    v = view(cloud);
    v.quality.budget = 0;
    expectPictureOrReason(cloud, v);
}

TEST_P(HostileViews, ImpossibleOnesAreRefused) {
    const Cloud& cloud = *clouds()[0].cloud;
    for (const double fov : {0.0, 180.0, -60.0, nan, infinity}) {
        View v = view(cloud);
        v.camera.fov = fov;
        expectReason(cloud, v);
    }
    for (const double coordinate : {nan, infinity, -infinity}) {
        View v = view(cloud);
        v.camera.eye.y = coordinate;
        expectReason(cloud, v);
    }
    View v = view(cloud);
    v.camera.target = v.camera.eye;
    expectReason(cloud, v);
    v = view(cloud);
    v.width = 0;
    expectReason(cloud, v);
    v = view(cloud);
    v.quality.detail = -1;
    expectReason(cloud, v);
    v.quality.detail = nan;
    expectReason(cloud, v);
}

TEST_P(HostileViews, ParametersAtTheirLimitsAndBeyond) {
    const Cloud& cloud = *clouds()[0].cloud;
    for (const Parameter& p : GetParam()->parameters) {
        if (p.type != Parameter::Type::Number) continue;
        SCOPED_TRACE(p.name);
        for (const double value : {p.min, p.max}) {
            View v = view(cloud);
            v.style.parameters[p.name] = value;
            expectPictureOrReason(cloud, v);
        }
        for (const double value : {p.min - 1, p.max + 1, nan, infinity}) {
            View v = view(cloud);
            v.style.parameters[p.name] = value;
            expectReason(cloud, v);
        }
    }
}

TEST_P(HostileViews, CanBeAbandoned) {
    // Right because the picture is asked to stop before it begins: nothing may be waited for.
    const Cloud& cloud = *clouds()[0].cloud;
    std::stop_source stop;
    stop.request_stop();
    const auto frame = render(*device_, cloud, view(cloud), {}, stop.get_token());
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::Cancelled);
}

std::vector<const Method*> everyMethod() {
    std::vector<const Method*> all;
    for (const Method& m : methods()) all.push_back(&m);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Methods, HostileViews, testing::ValuesIn(everyMethod()),
                         [](const testing::TestParamInfo<const Method*>& m) { return m.param->name; });

}  // namespace
}  // namespace scancast
