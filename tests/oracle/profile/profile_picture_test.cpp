// A profile's picture against brute force: for each pixel, of all points whose square covers it the one farthest to the right of
// the line, over the scan's own points.
#include "renderer/profile/profile_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/profile/grow_dots.hpp"
#include "renderer/residency/file_of.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast {
namespace {

class ProfilePictureTest : public ::testing::Test {
  protected:
    static constexpr std::uint64_t points = test::sized(40'000, 8'000);

    static std::unique_ptr<PointSource> survey() {
        const auto make = [](std::uint64_t i, std::uint64_t n) {
            auto p = test::ground(i, n);
            p.intensity = std::uint16_t(i * 7);
            p.classification = std::uint8_t(1 + i % 9);
            return p;
        };
        return std::make_unique<test::SyntheticSource>(
            points, make, Attributes{.color = true, .intensity = true, .classification = true}, 0.001);
    }
    void SetUp() override {
        const auto source = survey();
        auto built =
            buildCloud(*source, {.title = "survey", .shape = {.leafPoints = 4096, .chunkPoints = 50'000}});
        ASSERT_TRUE(built) << built.error().message;
        cloud = *built;
        auto file = fileOf(cloud);
        ASSERT_TRUE(file);
        all = *file;
        request.line = {{10, 10}, {150, 20}, {160, 180}};
        request.width = 8;
        request.picture.width = 300;
        request.picture.style.background = {.kind = Background::Kind::Transparent};
    }
    std::unique_ptr<ProfileDrawing> drawn(std::uint64_t mostPixels = 1'000'000) const {
        auto drawing = ProfileDrawing::create(*cloud, all, request, mostPixels);
        EXPECT_TRUE(drawing) << drawing.error().message;
        for (;;) {
            const auto more = (*drawing)->step();
            EXPECT_TRUE(more) << more.error().message;
            if (!more || !*more) return std::move(*drawing);
        }
    }

    std::shared_ptr<const Cloud> cloud;
    std::shared_ptr<const CloudFile> all;
    ProfileRequest request;
};

TEST_F(ProfilePictureTest, EachPixelShowsThePointInFrontOfIt) {
    request.picture.pointSize = 2;
    request.picture.exaggeration = 3;
    request.picture.style.color = ColorSource::Rgb;
    request.picture.style.exposure = 0;
    const auto drawing = drawn();
    const ProfileScale& scale = drawing->scale();
    const auto corridor = Corridor::create(request.line, request.width);
    const auto source = cloudPoints(all);
    const auto every = test::readAll(*source);
    ASSERT_TRUE(every);
    struct Pixel {
        double offset = -1e9;
        Rgb8 color{};
    };
    std::vector<Pixel> expected(std::size_t(scale.width) * std::size_t(scale.height));
    std::uint64_t inside = 0;
    for (std::size_t i = 0; i < every->size(); ++i) {
        const auto place = corridor->place(glm::dvec2(every->position[i]));
        if (!place) continue;
        ++inside;
        const int x = std::min(int(std::floor(place->station * scale.perStation)), scale.width - 1);
        const int up =
            std::min(int(std::floor((every->position[i].z - scale.low) * scale.perHeight)), scale.height - 1);
        for (int dy = 0; dy < 2; ++dy)
            for (int dx = 0; dx < 2; ++dx) {
                const int px = x + dx, py = scale.height - 1 - up + dy;
                if (px >= scale.width || py >= scale.height) continue;
                Pixel& pixel = expected[std::size_t(py) * std::size_t(scale.width) + std::size_t(px)];
                if (place->offset > pixel.offset) pixel = {place->offset, every->color[i]};
            }
    }
    EXPECT_EQ(drawing->points(), inside);
    const Frame frame = drawing->frame();
    std::size_t covered = 0, wrong = 0;
    for (std::size_t p = 0; p < expected.size(); ++p) {
        const bool there = expected[p].offset > -1e9;
        ASSERT_EQ(frame.rgba[4 * p + 3], there ? 255 : 0) << p;
        covered += there;
        if (there) wrong += std::memcmp(&frame.rgba[4 * p], expected[p].color.data(), 3) != 0;
    }
    EXPECT_GT(covered, 500U);
    EXPECT_LE(wrong, covered / 1000) << "offsets closer than 2^-31 of the width may change places";
}

/// What grow_dots.hpp says, looked up among all pairs.
TEST(ProfileDots, GrowToTheSecondNearestAndNoFarther) {
    for (const int most : {1, 2, 5, 8})
        for (const double share : {0.002, 0.02, 0.2, 0.8}) {
            constexpr int width = 61, height = 43;
            std::vector<std::uint64_t> pixels(std::size_t(width) * height);
            struct Dot {
                int x, y;
                std::uint64_t value;
            };
            std::vector<Dot> dots;
            for (std::uint64_t i = 0; i < pixels.size(); ++i)
                if (test::uniform(i, 5) < share) {
                    pixels[i] = 1 + std::uint64_t(1e6 * test::uniform(i, 6));
                    dots.push_back({int(i) % width, int(i) / width, pixels[i]});
                }
            std::vector<std::uint64_t> expected(pixels.size());
            for (std::size_t d = 0; d < dots.size(); ++d) {
                std::vector<int> away{most, most};
                for (std::size_t o = 0; o < dots.size(); ++o)
                    if (o != d)
                        away.push_back(
                            std::max(std::abs(dots[o].x - dots[d].x), std::abs(dots[o].y - dots[d].y)));
                std::ranges::nth_element(away, away.begin() + 1);
                const int side = away[1], left = dots[d].x - (side - 1) / 2, top = dots[d].y - (side - 1) / 2;
                for (int y = std::max(top, 0); y < std::min(top + side, height); ++y)
                    for (int x = std::max(left, 0); x < std::min(left + side, width); ++x) {
                        auto& pixel = expected[std::size_t(y) * width + std::size_t(x)];
                        pixel = std::max(pixel, dots[d].value);
                    }
            }
            growDots(pixels, width, most);
            EXPECT_EQ(pixels, expected) << most << " " << share;
        }
}

/// A scan of a floor and of a wall behind it, so sparse that points lie four pixels apart: in its picture the floor is a line and the wall an
/// area. Both are to be seen as such, and nothing beyond them.
TEST(ProfileDots, SparsePlanesAreCoveredAndNothingBeyondThem) {
    constexpr double apart = 0.5;
    constexpr int along = 80, up = 21;
    const auto scan = [](std::uint64_t i, std::uint64_t) {
        test::ScanPoint p;
        const auto column = double(i % along), row = double(i / along);
        // Less than a tenth of a pixel off a grid, as scanners are.
        const double off = 0.02 * (test::uniform(i, 1) - 0.5);
        p.position = row < up ? glm::dvec3(column * apart + off, 0.4, 1.0625 + row * apart + off)
                              : glm::dvec3(column * apart + off, -0.4, 0);
        p.color = {200, 100, 50};
        return p;
    };
    test::SyntheticSource source(std::uint64_t(along) * (up + 1), scan, Attributes{.color = true}, 0.001);
    const auto cloud = buildCloud(source, {.title = "wall"});
    ASSERT_TRUE(cloud) << cloud.error().message;
    const auto file = fileOf(*cloud);
    ASSERT_TRUE(file);
    ProfileRequest request;
    request.line = {{-0.0625, 0}, {39.9375, 0}};  // points in the middle of pixels
    request.width = 2;
    request.picture.width = 320;  // 8 px a unit
    request.picture.style.background = {.kind = Background::Kind::Transparent};
    const auto picture = [&](std::optional<int> size) {
        request.picture.pointSize = size;
        auto drawing = ProfileDrawing::create(**cloud, *file, request, 1'000'000);
        EXPECT_TRUE(drawing);
        while ((*drawing)->step().value()) {
        }
        return std::pair((*drawing)->frame(), (*drawing)->scale());
    };
    const auto [frame, scale] = picture(std::nullopt);
    const auto covered = [&, &frame = frame, &scale = scale](double low, double high) {
        std::size_t there = 0, all = 0;
        for (int y = 0; y < scale.height; ++y) {
            const double z = scale.high() - (y + 0.5) / scale.perHeight;
            for (int x = 0; x < scale.width && z > low && z < high; ++x, ++all)
                there +=
                    frame.rgba[4 * (std::size_t(y) * std::size_t(scale.width) + std::size_t(x)) + 3] == 255;
        }
        return double(there) / double(std::max<std::size_t>(all, 1));
    };
    EXPECT_GT(covered(0, 0.12), 0.95) << "the floor's line";
    EXPECT_GT(covered(1.1, 10.9), 0.95) << "the wall's area";
    EXPECT_EQ(covered(0.4, 0.7), 0) << "between them, farther off than half of what points are apart";
    const auto alone = picture(1).first;
    std::size_t grown = 0, small = 0;
    for (std::size_t p = 3; p < alone.rgba.size(); p += 4)
        small += alone.rgba[p] == 255, grown += frame.rgba[p] == 255;
    EXPECT_LT(small * 10, grown) << "a pixel each is a sixteenth";

    // The same scan from so far away that its points lie in neighbouring pixels: as it was.
    request.picture.width = 80;
    const auto dense = picture(std::nullopt).first, before = picture(1).first;
    EXPECT_TRUE(std::ranges::equal(dense.rgba, before.rgba));
}

TEST_F(ProfilePictureTest, EverythingFitsInAndTheScaleSaysWhere) {
    const auto reach = [&](const ProfileDrawing& drawing) {
        const ProfileScale& scale = drawing.scale();
        EXPECT_EQ(scale.low, drawing.heights()[0]);
        EXPECT_GE(scale.high(), drawing.heights()[1] - 1e-9);
        EXPECT_GE(scale.lastStation(), drawing.length() - 1e-9);
        return scale;
    };
    const ProfileScale plain = reach(*drawn());
    EXPECT_DOUBLE_EQ(plain.perHeight, plain.perStation);
    EXPECT_NEAR(plain.lastStation(), drawn()->length(), 1e-9);
    request.picture.height = 90;
    const ProfileScale filled = reach(*drawn());
    EXPECT_EQ(filled.height, 90);
    EXPECT_NEAR(filled.high(), drawn()->heights()[1], 1e-9);
    request.picture.exaggeration = 50;
    const ProfileScale steep = reach(*drawn());
    EXPECT_NEAR(steep.perHeight, 50 * steep.perStation, 1e-9);
    request.picture.height.reset();
    request.picture.exaggeration = 1000;
    const ProfileScale bounded = reach(*drawn(30'000));
    EXPECT_LE(bounded.width * bounded.height, 30'000);
}

TEST(ProfilePixels, AreAtMostThoseOfTheWholeCloud) {
    constexpr std::uint64_t most = 40'000;
    for (const std::optional<int> height : {std::optional<int>(), std::optional(100)})
        for (const std::optional<double> exaggeration : {std::optional<double>(), std::optional(7.5)}) {
            ProfilePicture picture;
            picture.width = 200;
            picture.height = height;
            picture.exaggeration = exaggeration;
            const std::uint64_t allowed = mostProfilePixels(picture, 50, {-10, 20}, most);
            EXPECT_LE(allowed, most);
            if (!height && !exaggeration) {
                EXPECT_EQ(allowed, 200U * 120U);
            }
            std::uint64_t seen = 0;
            for (double low = -10; low <= 20; low += 0.37)
                for (double high = low; high <= 20; high += 0.37) {
                    const ProfileScale scale = profileScale(picture, 50, {low, high}, most);
                    seen = std::max(seen, std::uint64_t(scale.width) * std::uint64_t(scale.height));
                }
            EXPECT_LE(seen, allowed);
            EXPECT_GT(seen, allowed * 9 / 10) << "more is kept free than is ever needed";
        }
}

TEST_F(ProfilePictureTest, ColoursAreThoseOfViews) {
    for (const ColorSource source : {ColorSource::Rgb, ColorSource::Intensity, ColorSource::Elevation,
                                     ColorSource::Classification, ColorSource::Flat}) {
        request.picture.style.color = source;
        request.picture.style.flatColor = {255, 0, 0};
        const Frame frame = drawn()->frame();
        std::set<std::array<std::uint8_t, 3>> colors;
        for (std::size_t p = 0; p < frame.rgba.size(); p += 4)
            if (frame.rgba[p + 3] == 255)
                colors.insert({frame.rgba[p], frame.rgba[p + 1], frame.rgba[p + 2]});
        if (source == ColorSource::Flat) {
            EXPECT_EQ(colors, (std::set<std::array<std::uint8_t, 3>>{{255, 0, 0}}));
        } else {
            EXPECT_GE(colors.size(), 9U) << name(source);
        }
        if (source == ColorSource::Classification) {
            EXPECT_EQ(colors.size(), 9U);
        }
    }
    for (const ColorSource source :
         {ColorSource::Depth, ColorSource::Lod, ColorSource::Curvature, ColorSource::Infrared}) {
        request.picture.style.color = source;
        const auto refused = ProfileDrawing::create(*cloud, all, request, 1'000'000);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
        EXPECT_EQ(refused.error().field, "picture.color");
    }
}

TEST_F(ProfilePictureTest, WhereNothingIsThereIsNoPicture) {
    request.line = {{-50, -50}, {-40, -50}};
    auto drawing = ProfileDrawing::create(*cloud, all, request, 1'000'000);
    ASSERT_TRUE(drawing);
    for (;;) {
        const auto more = (*drawing)->step();
        if (more && *more) continue;
        ASSERT_FALSE(more);
        EXPECT_EQ(more.error().code, ErrorCode::Empty);
        break;
    }
    request.picture.width = 2000;
    EXPECT_EQ(ProfileDrawing::create(*cloud, all, request, 1000).error().code, ErrorCode::ResourceLimit);
}

}  // namespace
}  // namespace scancast
