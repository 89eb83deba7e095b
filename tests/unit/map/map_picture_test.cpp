// Maps against arithmetic: the picture that is to be drawn is made here, of a function of the place, and each pixel of the map must be that
// function at its own place.
#include "renderer/map/map_picture.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace scancast {
namespace {

constexpr std::uint64_t plenty = 100'000'000;

CloudFacts square(double side) {
    CloudFacts cloud;
    cloud.bounds = {glm::dvec3(0), glm::dvec3(side, side, 10)};
    cloud.spacing = 0.1;
    return cloud;
}

/// Of the file's coordinates to the map's: a turn, another unit, and something that bends.
struct Bend {
    double amount = 0;
    glm::dvec2 toMap(const glm::dvec2& p) const {
        const glm::dvec2 turned(p.x * 0.96 - p.y * 0.28, p.x * 0.28 + p.y * 0.96);
        return glm::dvec2(turned.x * 3 + amount * turned.y * turned.y, turned.y * 3) + glm::dvec2(1000, 2000);
    }
    glm::dvec2 toFile(const glm::dvec2& q) const {
        const glm::dvec2 p = q - glm::dvec2(1000, 2000);
        const double y = p.y / 3, x = (p.x - amount * y * y) / 3;
        return {x * 0.96 + y * 0.28, -x * 0.28 + y * 0.96};
    }
    MapProjection projection() const {
        return {[this](std::span<glm::dvec2> places) {
                    for (auto& place : places) place = toFile(place);
                },
                [this](std::span<glm::dvec2> places) {
                    for (auto& place : places) place = toMap(place);
                }};
    }
};

/// Red by x and green by y, linear: a place can be read from a colour.
Frame drawn(const MapPicture& picture, double side) {
    Frame frame = emptyMap(picture.width, picture.height, std::nullopt);
    auto& rgba = frame.rgba.own();
    const double perPixel = picture.camera.viewHeight / picture.height;
    std::size_t at = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x, at += 4) {
            const glm::dvec2 place(picture.camera.target.x + (x + 0.5 - picture.width * 0.5) * perPixel,
                                   picture.camera.target.y - (y + 0.5 - picture.height * 0.5) * perPixel);
            rgba[at] = std::uint8_t(std::lround(std::clamp(place.x / side, 0.0, 1.0) * 255));
            rgba[at + 1] = std::uint8_t(std::lround(std::clamp(place.y / side, 0.0, 1.0) * 255));
            rgba[at + 3] = 255;
        }
    return frame;
}

const std::uint8_t* pixelOf(const Frame& frame, int x, int y) {
    return frame.rgba.data() + (std::size_t(y) * std::size_t(frame.width) + std::size_t(x)) * 4;
}

TEST(MapPicture, OfSquarePixelsInTheCloudsCoordinatesIsItself) {
    const MapExtent extent{{10, 20}, {40, 40}, 300, 200};
    const auto picture = mapPicture(square(100), extent, {}, std::nullopt, {0, plenty});
    ASSERT_TRUE(picture && *picture);
    EXPECT_EQ((*picture)->warp, nullptr);
    EXPECT_EQ((*picture)->width, 300);
    EXPECT_EQ((*picture)->camera.viewHeight, 20);
    EXPECT_EQ(glm::dvec2((*picture)->camera.eye), glm::dvec2(25, 30));
    EXPECT_EQ(extent.placeAt({0.5, 0.5}), glm::dvec2(10.05, 39.95));
}

TEST(MapPicture, MarginsAreCutOffAgain) {
    const MapExtent extent{{10, 20}, {40, 40}, 30, 20};
    const auto picture = mapPicture(square(100), extent, {}, std::nullopt, {7, plenty});
    ASSERT_TRUE(picture && *picture && (*picture)->warp);
    EXPECT_EQ((*picture)->width, 44);
    EXPECT_DOUBLE_EQ((*picture)->camera.viewHeight, 34);
    const Frame whole = drawn(**picture, 100);
    const auto map = (*picture)->warp->apply(whole);
    ASSERT_TRUE(map);
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 30; ++x)
            for (int c = 0; c < 4; ++c) ASSERT_EQ(pixelOf(*map, x, y)[c], pixelOf(whole, x + 7, y + 7)[c]);
}

TEST(MapPicture, EveryPixelOfAProjectedMapShowsItsPlace) {
    constexpr double side = 100;
    for (const double amount : {0.0, 0.002, 0.02}) {
        const Bend bend{amount};
        const MapExtent extent{{1010, 2020}, {1250, 2280}, 240, 256};
        const auto picture = mapPicture(square(side), extent, bend.projection(), std::nullopt, {3, plenty});
        ASSERT_TRUE(picture && *picture && (*picture)->warp);
        const MapWarp& warp = *(*picture)->warp;
        EXPECT_LE(warp.error, 0.125);
        const double perPixel = (*picture)->camera.viewHeight / (*picture)->height;
        EXPECT_LE(perPixel, 1.0 / 3 + 1e-9) << "at least as fine as the map";
        const auto map = warp.apply(drawn(**picture, side));
        ASSERT_TRUE(map);
        int seen = 0;
        glm::dvec2 off(0);
        for (int y = 0; y < extent.height; ++y) {
            for (int x = 0; x < extent.width; ++x) {
                const glm::dvec2 place = bend.toFile(extent.placeAt({x + 0.5, y + 0.5}));
                if (place.x < 1 || place.y < 1 || place.x > side - 1 || place.y > side - 1) continue;
                ++seen;
                // The picture's colours and the map's are rounded; and what a quarter of a pixel is.
                const double most = 1.01 + 255 * 0.25 * perPixel / side;
                off += glm::dvec2(pixelOf(*map, x, y)[0], pixelOf(*map, x, y)[1]) - place / side * 255.0;
                ASSERT_NEAR(pixelOf(*map, x, y)[0], place.x / side * 255, most) << x << " " << y;
                ASSERT_NEAR(pixelOf(*map, x, y)[1], place.y / side * 255, most) << x << " " << y;
            }
        }
        EXPECT_GT(seen, 20000);
        // Rounding goes both ways: a tenth of a pixel would be seen.
        EXPECT_NEAR(off.x / seen, 0, 255 * 0.1 * perPixel / side);
        EXPECT_NEAR(off.y / seen, 0, 255 * 0.1 * perPixel / side);
    }
}

TEST(MapPicture, WherePixelsAreNotSquareTheyAreMadeOfFinerOnes) {
    const MapExtent extent{{10, 10}, {90, 90}, 100, 400};
    const auto picture = mapPicture(square(100), extent, {}, Rgb8{1, 2, 3}, {0, plenty});
    ASSERT_TRUE(picture && *picture && (*picture)->warp);
    EXPECT_LE((*picture)->camera.viewHeight / (*picture)->height, 0.2 + 1e-9);
    const auto map = (*picture)->warp->apply(drawn(**picture, 100));
    ASSERT_TRUE(map);
    for (int y = 0; y < 400; y += 7)
        for (int x = 0; x < 100; x += 3) {
            ASSERT_NEAR(pixelOf(*map, x, y)[0], extent.placeAt({x + 0.5, y + 0.5}).x * 2.55, 1.01);
            ASSERT_NEAR(pixelOf(*map, x, y)[1], extent.placeAt({x + 0.5, y + 0.5}).y * 2.55, 1.01);
        }
}

TEST(MapPicture, OfNothingThereIsNone) {
    const auto away =
        mapPicture(square(100), {{500, 500}, {600, 600}, 64, 64}, {}, std::nullopt, {9, plenty});
    ASSERT_TRUE(away);
    EXPECT_FALSE(*away);
    const Bend bend{0.002};
    const auto projected = mapPicture(square(100), {{9000, 9000}, {9100, 9100}, 64, 64}, bend.projection(),
                                      std::nullopt, {9, plenty});
    ASSERT_TRUE(projected);
    EXPECT_FALSE(*projected);
}

TEST(MapPicture, OfTheWholeWorldDrawsNoMoreThanTheCloud) {
    const Bend bend{1e-9};
    const auto picture = mapPicture(square(100), {{-2e7, -2e7}, {2e7, 2e7}, 256, 256}, bend.projection(),
                                    std::nullopt, {9, plenty});
    ASSERT_TRUE(picture && *picture);
    EXPECT_LT((*picture)->width, 64);
    EXPECT_LT((*picture)->height, 64);
}

TEST(MapPicture, WhatIsTooLargeIsRefused) {
    const auto large = mapPicture(square(100), {{0, 0}, {90, 100}, 900, 999}, {}, std::nullopt, {0, 1000});
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, ErrorCode::ResourceLimit);
}

TEST(MapWarp, DoesNotBleedTheColourOfWhatIsTransparent) {
    MapWarp warp;
    warp.width = warp.height = 1;
    warp.size = {1, 1};
    warp.step = 1;
    warp.columns = warp.rows = 2;
    warp.nodes = {{0.5, 0.5}, {1.5, 0.5}, {0.5, 1.5}, {1.5, 1.5}};
    Frame picture = emptyMap(2, 2, Rgb8{200, 100, 50});
    for (std::size_t i : {4, 8}) {  // two of them without anything, whatever colour they have
        picture.rgba.own()[i] = 0;
        picture.rgba.own()[i + 3] = 0;
    }
    const auto map = warp.apply(picture);
    ASSERT_TRUE(map);
    EXPECT_EQ(std::vector<int>(map->rgba.begin(), map->rgba.end()), (std::vector<int>{200, 100, 50, 128}));
}

TEST(MapPicture, APlaceUnderAPixelHasItsSize) {
    const Bend bend{0};
    const MapExtent extent{{1000, 2000}, {1300, 2300}, 100, 100};
    const auto place = placeUnder(extent, bend.projection(), {50, 50});
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->unitsPerPixel, 1, 1e-9);
    EXPECT_NEAR(glm::distance(bend.toMap(place->place), glm::dvec2(1150, 2150)), 0, 1e-9);
}

}  // namespace
}  // namespace scancast
