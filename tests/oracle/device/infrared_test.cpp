// Colour infrared, from points to pixels. Right because a scan whose own colours are another's near infrared, red and green
// must look, in those colours, as the other does in infrared: the same bytes, in every method, on every device.
#include <gtest/gtest.h>

#include "protocol/view/view_words.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

constexpr std::uint64_t points = 12'000;

/// A coloured ball without normals. `permuted`: its own colours are near infrared, red and green.
std::unique_ptr<PointSource> coloredBall(bool permuted) {
    const auto make = [permuted](std::uint64_t i, std::uint64_t n) {
        ScanPoint p = ball(i, n);
        const auto channel = [&](int c) { return std::uint8_t(127 + p.position[c] * 12); };
        const auto infrared = std::uint8_t(255 * uniform(i, 4));
        const Rgb8 own{channel(0), channel(1), channel(2)};
        p.color = permuted ? Rgb8{infrared, own[0], own[1]} : own;
        p.nearInfrared = std::uint16_t(infrared * 257);
        return p;
    };
    return std::make_unique<SyntheticSource>(points, make,
                                             Attributes{.color = true, .nearInfrared = !permuted}, 0.001);
}

OctreeShape shape() {
    OctreeShape made;
    made.leafPoints = 1000;
    made.surfels = true;
    return made;
}

std::shared_ptr<const Cloud> cloudOf(bool permuted) {
    BuildOptions options;
    options.shape = shape();
    auto cloud = buildCloud(*coloredBall(permuted), options, {});
    EXPECT_TRUE(cloud) << cloud.error().message;
    return cloud ? *cloud : nullptr;
}

/// The same scan three times, built once.
struct Clouds {
    std::shared_ptr<const Cloud> infrared = cloudOf(false), permuted = cloudOf(true), inFile;
    TemporaryFolder folder;
    std::shared_ptr<BlockCache> cache;

    Clouds() {
        IngestOptions options;
        options.shape = shape();
        options.output = folder / "infrared.scan";
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(coloredBall(false));
        const auto report = ingest(std::move(sources), options, {}, {});
        EXPECT_TRUE(report) << report.error().message;
        BlockCacheOptions room;
        room.memoryLimit = std::uint64_t(256) << 20;
        cache = BlockCache::create(room);
        auto opened = openCloud(options.output, cache);
        EXPECT_TRUE(opened) << opened.error().message;
        if (opened) inFile = *opened;
    }
};

class ColorInfrared : public OnDevice {
  protected:
    static void SetUpTestSuite() { clouds_ = std::make_unique<Clouds>(); }
    static void TearDownTestSuite() { clouds_.reset(); }
    static std::unique_ptr<Clouds> clouds_;

    Frame picture(const Cloud& cloud, const std::string& method, const std::string& color,
                  const std::string& exposure) const {
        View view = defaultView(*clouds_->infrared, 96, 72);
        view = applyWords(view, {{"method", method}, {"color", color}, {"exposure", exposure}}).value();
        view.quality.samples = 1;
        auto frame = render(*device_, cloud, view, {.wait = true});
        EXPECT_TRUE(frame) << frame.error().message;
        return frame ? std::move(*frame) : Frame();
    }
};
std::unique_ptr<Clouds> ColorInfrared::clouds_;
SCANCAST_ON_DEVICES(ColorInfrared, "egl");

TEST_P(ColorInfrared, IsTheSamePictureAsOfColorsThatWerePermuted) {
    ASSERT_TRUE(clouds_->infrared && clouds_->permuted && clouds_->inFile);
    // Colours are looked up while splatting, for sums, and by sample.
    const std::vector<std::string> all{"paraboloid", "point", "hqs", "disc", "ewa", "voronoi", "pyramid"},
        few{"paraboloid", "ewa", "voronoi"};
    for (const std::string& method : slow_ ? few : all)
        for (const char* exposure : {"0", "1"}) {
            SCOPED_TRACE(method + ", " + exposure + " stops");
            const Frame expected = picture(*clouds_->permuted, method, "rgb", exposure);
            ASSERT_FALSE(expected.rgba.empty());
            EXPECT_TRUE(picture(*clouds_->infrared, method, "cir", exposure).rgba == expected.rgba);
            EXPECT_TRUE(picture(*clouds_->inFile, method, "cir", exposure).rgba == expected.rgba) << "in a file";
            EXPECT_FALSE(picture(*clouds_->infrared, method, "rgb", exposure).rgba == expected.rgba);
        }
}

/// What stands beside it in the same word stays what it is.
TEST_P(ColorInfrared, ChangesNothingElse) {
    for (const char* color : {"curvature", "elevation"})
        for (const char* method : {"ewa", "voronoi"})
            EXPECT_TRUE(picture(*clouds_->infrared, method, color, "0").rgba ==
                        picture(*clouds_->permuted, method, color, "0").rgba)
                << method << ", " << color;
}

}  // namespace
}  // namespace scancast::test
