// Flights along saved views. The oracles: what an even orbit and a straight line must be, and differences of positions.
#include "client/cpp/program/tour/tour_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace scancast::client {
namespace {

struct Saved {
    std::string name;
    WordValues words;
};

ProjectTours projectOf(const std::vector<Saved>& views, double seconds, double pause, bool loop = false) {
    ProjectTours project{"town", {}, {{"Tour", {}, seconds, pause, loop}}};
    for (const auto& [name, words] : views) {
        project.tours[0].stops.push_back(project.views.size());
        project.views.push_back({name, words});
    }
    return project;
}

Expected<TourFlight> alongTour(const ProjectTours& project, const WordValues& changes = {}) {
    return TourFlight::create({}, project, project.tours[0], changes, {{0, 0, 0}, 10});
}

TourFlight flightOf(const ProjectTours& project) {
    auto flight = alongTour(project);
    EXPECT_TRUE(flight) << flight.error().message;
    return *flight;
}

std::string spelled(double x, double y, double z) {
    return std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(z);
}

Saved onOrbit(double degrees, const std::string& method = "point") {
    const double angle = degrees * std::numbers::pi / 180;
    return {std::to_string(degrees),
            {{"eye", spelled(10 * std::cos(angle), 10 * std::sin(angle), 5)},
             {"target", "0,0,0"},
             {"method", method}}};
}

// An orbit: right because its eye stays as far from the axis and as high as its views are, and comes by each of them.
TEST(TourFlight, AnOrbitStaysOne) {
    const auto flight =
        flightOf(projectOf({onOrbit(0), onOrbit(90), onOrbit(180), onOrbit(270)}, 2, 0, true));
    EXPECT_DOUBLE_EQ(flight.seconds(), 8);
    for (double time = 0; time <= 8; time += 0.125) {
        const auto eye = flight.at(time).camera.eye;
        EXPECT_NEAR(std::hypot(eye.x, eye.y), 10, 1e-4) << time;
        EXPECT_NEAR(eye.z, 5, 1e-4) << time;
    }
    EXPECT_LT(glm::distance(flight.at(2).camera.eye, {0, 10, 5}), 1e-5);
    EXPECT_LT(glm::distance(flight.at(7.999).camera.eye, {10, 0, 5}), 0.05) << "round, by the shorter way";
    EXPECT_GT(flight.at(1).camera.eye.y, 5);
}

TEST(TourFlight, RestsAtEachViewAndTakesItsStyle) {
    const auto project = projectOf({onOrbit(0, "point"), onOrbit(60, "disc"), onOrbit(120, "cone")}, 2, 1);
    const auto flight = flightOf(project);
    EXPECT_DOUBLE_EQ(flight.seconds(), 7);
    EXPECT_EQ(flight.at(0), flight.at(1)) << "at rest";
    EXPECT_EQ(flight.at(3), flight.at(4));
    EXPECT_FALSE(flight.at(4.2).camera == flight.at(4).camera);
    EXPECT_EQ(flight.at(2.9).style.method, "point") << "until it has arrived";
    EXPECT_EQ(flight.at(3).style.method, "disc");
    EXPECT_EQ(flight.at(7).style.method, "cone");
    EXPECT_EQ(flight.at(99), flight.at(7));
    // It sets out and arrives slowly.
    const auto speed = [&](double time) {
        return glm::distance(flight.at(time).camera.eye, flight.at(time + 0.01).camera.eye) / 0.01;
    };
    EXPECT_LT(speed(1.001), 0.2 * speed(2));
    EXPECT_LT(speed(2.98), 0.2 * speed(2));
}

// Where it does not rest, it neither stops nor leaps at a view, however unevenly views lie.
TEST(TourFlight, SpeedDoesNotJumpAtAViewWithoutAPause) {
    const auto line = [](double x, double y) {
        return Saved{spelled(x, y, 0), {{"eye", spelled(x, y - 10, 4)}, {"target", spelled(x, y, 0)}}};
    };
    const auto flight = flightOf(projectOf({line(0, 0), line(2, 0), line(30, 10), line(60, -10)}, 2, 0));
    const double h = 1e-5;
    const auto eye = [&](double time) { return flight.at(time).camera.eye; };
    for (const double time : {2.0, 4.0}) {
        const auto before = (eye(time) - eye(time - h)) / h, after = (eye(time + h) - eye(time)) / h;
        EXPECT_LT(glm::distance(before, after), 1e-2 * glm::length(before) + 1e-6) << time;
        EXPECT_GT(glm::length(before), 0.1) << time;
    }
}

// A line: right because what looks across it never leaves it, and never goes back.
TEST(TourFlight, AlongALineItNeverGoesBack) {
    std::vector<Saved> views;
    for (const double x : {0.0, 1.0, 50.0, 51.0, 51.0, 200.0})
        views.push_back(
            {std::to_string(views.size()), {{"eye", spelled(x, -10, 0)}, {"target", spelled(x, 0, 0)}}});
    const auto flight = flightOf(projectOf(views, 1, 0));
    double before = -1e-9;
    for (double time = 0; time <= 5; time += 0.02) {
        const auto camera = flight.at(time).camera;
        EXPECT_NEAR(camera.eye.y, -10, 1e-6);
        EXPECT_GE(camera.eye.x, before - 1e-6) << time;
        before = camera.eye.x;
    }
}

// Legs of 1 : 1000, much turning beside none: right because nothing leaves what its leg's ends have.
TEST(TourFlight, HoweverUnlikeItsLegsAreItNeitherLoopsNorOvershoots) {
    const auto away = [](const std::string& name, double x, double y) {
        return Saved{name, {{"eye", spelled(x, y, 0)}, {"target", "0,0,0"}}};
    };
    for (const double pause : {0.0, 2.0}) {
        const auto flight = flightOf(projectOf({away("a", 1, 0), away("b", 0, 1), away("c", 0, 1000),
                                                away("d", 0, 10), away("e", 0, 1), away("f", 0, 900)},
                                               4, pause));
        const std::vector<double> distances{1, 1, 1000, 10, 1, 900};
        for (double time = 0; time <= flight.seconds(); time += 0.05) {
            const auto leg = std::min<std::size_t>(4, static_cast<std::size_t>(time / (4 + pause)));
            const auto eye = flight.at(time).camera.eye;
            const double distance = glm::length(eye);
            EXPECT_GE(distance, std::min(distances[leg], distances[leg + 1]) * (1 - 1e-6)) << time;
            EXPECT_LE(distance, std::max(distances[leg], distances[leg + 1]) * (1 + 1e-6)) << time;
            EXPECT_GE(eye.x, -1e-6 * distance) << "no turn that nobody asked for, " << time;
            EXPECT_GE(eye.y, -1e-6 * distance) << time;
        }
    }
}

TEST(TourFlight, FromTheTopToASideAndBackIntoPerspective) {
    const auto flight = flightOf(
        projectOf({{"top",
                    {{"eye", "0,0,80"},
                     {"target", "0,0,0"},
                     {"up", "0,1,0"},
                     {"projection", "orthographic"},
                     {"viewHeight", "60"}}},
                   {"south", {{"eye", "0,-50,0"}, {"target", "0,0,0"}, {"up", "0,0,1"}, {"fov", "40"}}}},
                  2, 0));
    EXPECT_EQ(flight.at(0).camera.projection, Projection::Orthographic);
    EXPECT_EQ(flight.at(0).camera.viewHeight, 60);
    const auto camera = flight.at(1).camera;
    EXPECT_EQ(camera.projection, Projection::Orthographic) << "until it has arrived";
    EXPECT_LT(camera.eye.y, 0) << "north stays above: it comes down in the south";
    EXPECT_NEAR(camera.eye.x, 0, 1e-6);
    EXPECT_GE(glm::length(camera.eye), 11) << "outside of the cloud";
    EXPECT_EQ(flight.at(2).camera.projection, Projection::Perspective);
    EXPECT_EQ(flight.at(2).camera.fov, 40);
    // What was above stays above: just before the pole the picture's up is north.
    EXPECT_GT(flight.at(1e-4).camera.up.y, 0.99);
}

TEST(TourFlight, WhatIsNoTourSaysWhy) {
    const auto why = [](const ProjectTours& project, const WordValues& changes = {}) {
        const auto flight = alongTour(project, changes);
        EXPECT_FALSE(flight);
        return flight ? std::string() : flight.error().message;
    };
    EXPECT_NE(why(projectOf({onOrbit(0)}, 2, 1)).find("needs two saved views"), std::string::npos);
    EXPECT_NE(why(projectOf({onOrbit(0), {"odd", {{"eye", "0,0"}}}}, 2, 1)).find("the view \"odd\": eye"),
              std::string::npos);
    EXPECT_NE(why(projectOf({onOrbit(0), {"odd", {{"fvo", "60"}}}}, 2, 1)).find("fvo"), std::string::npos);
    EXPECT_NE(why(projectOf({onOrbit(0),
                             {"lies", {{"eye", "0,0,9"}, {"target", "0,0,0"}, {"up", "0,1,0"}}},
                             {"model", {{"eye", "0,1,9"}, {"target", "9,0,0"}, {"up", "0,1,0"}}}},
                            2, 1))
                  .find("another axis for up"),
              std::string::npos);
    EXPECT_NE(why(projectOf({onOrbit(0), onOrbit(9)}, 2, 1), {{"fov", "30"}}).find("camera of a tour"),
              std::string::npos);
    const auto red = alongTour(projectOf({onOrbit(0), onOrbit(9)}, 2, 1), {{"color", "#ff0000"}});
    ASSERT_TRUE(red);
    EXPECT_EQ(red->at(3).style.method, "point");
}

}  // namespace
}  // namespace scancast::client
