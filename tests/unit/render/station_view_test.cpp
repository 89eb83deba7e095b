// From where a photo was taken: what the camera there has to show.
#include "renderer/station_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

namespace scancast {
namespace {

constexpr double turn = 2 * std::numbers::pi;

Cloud emptyRoom() {
    Cloud cloud;
    cloud.bounds = {glm::dvec3(0), glm::dvec3(10, 10, 5)};
    return cloud;
}

Photo flat(double across, double down) {
    Photo photo;
    photo.projection = Photo::Projection::Pinhole;
    photo.angles = {across, down};
    const glm::dvec3 forwards = glm::normalize(glm::dvec3(1, 2, -0.5));
    photo.pose = Photo::Pose{{4, 5, 2}, forwards, glm::normalize(glm::cross(forwards, glm::dvec3(3, 1, 1)))};
    return photo;
}

// Right because the photo's corners, seen by the camera, lie in the picture, and two of its sides on the picture's.
TEST(PhotoCamera, ShowsAllOfAFlatPhotoUprightAsItIs) {
    for (const auto& [across, down] : {std::pair(0.9, 0.7), std::pair(0.4, 1.5), std::pair(2.0, 1.0)})
        for (const double aspect : {16.0 / 9, 1.0, 0.45, 4.0}) {
            const Photo photo = flat(across, down);
            const auto camera = photoCamera(emptyRoom(), photo, aspect);
            ASSERT_TRUE(camera);
            EXPECT_EQ(camera->eye, photo.pose->position);
            const glm::dvec3 ahead = glm::normalize(camera->target - camera->eye), &up = camera->up;
            const glm::dvec3 right = glm::cross(ahead, up);
            EXPECT_LT(glm::length(ahead - photo.pose->forwards), 1e-12);
            EXPECT_NEAR(glm::dot(ahead, up), 0, 1e-12);
            const glm::dvec3 theirRight = glm::cross(photo.pose->forwards, photo.pose->up);
            double farthest = 0;
            for (const int x : {-1, 1})
                for (const int y : {-1, 1}) {
                    const glm::dvec3 corner = photo.pose->forwards + theirRight * (x * std::tan(across / 2)) +
                                              photo.pose->up * (y * std::tan(down / 2));
                    const double depth = glm::dot(corner, ahead),
                                 half = std::tan(glm::radians(camera->fov) / 2);
                    farthest = std::max({farthest, std::abs(glm::dot(corner, right) / depth / half / aspect),
                                         std::abs(glm::dot(corner, up) / depth / half)});
                }
            EXPECT_NEAR(farthest, 1, 1e-9) << across << " x " << down << " in " << aspect;
        }
}

TEST(PhotoCamera, WhatIsNotKnownOfTheAnglesFollowsFromTheShapeOrIsUsual) {
    Photo photo = flat(0, 0);
    EXPECT_EQ(photoCamera(emptyRoom(), photo, 1)->fov, 75);
    photo.angles = {turn / 4, 0};
    photo.width = 400, photo.height = 200;
    // 45° to either side is as far as the middle is away; the height is half of that.
    EXPECT_NEAR(photoCamera(emptyRoom(), photo, 4)->fov, glm::degrees(2 * std::atan(0.5)), 1e-9);
    EXPECT_NEAR(photoCamera(emptyRoom(), photo, 1)->fov, 90, 1e-9);
    photo.angles = {turn, turn};  // no flat photo
    EXPECT_EQ(photoCamera(emptyRoom(), photo, 1)->fov, 75);
    photo.angles = {3.1415, 3.1415};
    EXPECT_EQ(photoCamera(emptyRoom(), photo, 1)->fov, 150);
    photo.angles = {1e-9, 1e-9};
    EXPECT_EQ(photoCamera(emptyRoom(), photo, 1)->fov, 0.1);
}

TEST(PhotoCamera, OfAPanoramaLooksToItsMiddleAsFromAStation) {
    for (const auto projection :
         {Photo::Projection::Spherical, Photo::Projection::Cylindrical, Photo::Projection::Visual}) {
        Photo photo = flat(turn, turn / 2);
        photo.projection = projection;
        const auto camera = photoCamera(emptyRoom(), photo, 1);
        ASSERT_TRUE(camera);
        EXPECT_EQ(*camera, stationCamera(emptyRoom(), {.position = photo.pose->position,
                                                       .forwards = photo.pose->forwards}));
        EXPECT_EQ(camera->up, glm::dvec3(0, 0, 1)) << "level, however the scanner's camera was held";
    }
}

TEST(PhotoCamera, WithoutAPoseThereIsNone) {
    Photo photo = flat(1, 1);
    photo.pose.reset();
    EXPECT_FALSE(photoCamera(emptyRoom(), photo, 1));
}

}  // namespace
}  // namespace scancast
