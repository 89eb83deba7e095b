// Shapes that cut: what they keep, by another way of turning a box (quaternions, the point into the box's frame); how they
// are written; that faces belong to them at coordinates as large as a map's.
#include "protocol/view/clip_shapes.hpp"

#include <gmock/gmock.h>

#include <glm/gtc/quaternion.hpp>
#include <random>

#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

using testing::HasSubstr;

class ShapeDice {
  public:
    explicit ShapeDice(unsigned seed) : engine_(seed) {}
    double between(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
    glm::dvec3 place(double reach) {
        return {between(-reach, reach), between(-reach, reach), between(-reach, reach)};
    }
    bool coin() { return between(0, 1) < 0.5; }

  private:
    std::mt19937 engine_;
};

ClipShapes randomShapes(ShapeDice& dice) {
    ClipShapes shapes;
    const int count = 1 + static_cast<int>(dice.between(0, 7.99));
    for (int i = 0; i < count; ++i) {
        if (dice.between(0, 1) < 0.3)
            shapes.push_back(HalfSpace{dice.place(8), dice.place(3)});
        else
            shapes.push_back(
                TurnedBox{dice.place(6), dice.place(4) + glm::dvec3(5), dice.place(360), dice.coin()});
    }
    return shapes;
}

/// How far the point is inside the shape's face that it is nearest to leaving by; negative: outside.
double depthIn(const ClipShape& shape, const glm::dvec3& p) {
    if (const auto* half = std::get_if<HalfSpace>(&shape))
        return glm::dot(glm::normalize(half->normal), p - half->point);
    const auto& box = std::get<TurnedBox>(shape);
    const glm::dvec3 turn = glm::radians(box.turn);
    const glm::dquat q = glm::angleAxis(turn.x, glm::dvec3(0, 0, 1)) *
                         glm::angleAxis(turn.y, glm::dvec3(0, 1, 0)) *
                         glm::angleAxis(turn.z, glm::dvec3(1, 0, 0));
    const glm::dvec3 own = glm::abs(glm::inverse(q) * (p - box.center));
    const glm::dvec3 left = box.size * 0.5 - own;
    return std::min({left.x, left.y, left.z});
}

bool keptByBruteForce(const ClipShapes& shapes, const glm::dvec3& p) {
    bool anyInside = false, inOne = false;
    for (const ClipShape& shape : shapes) {
        const bool in = depthIn(shape, p) >= 0;
        const auto* box = std::get_if<TurnedBox>(&shape);
        if (!box && !in) return false;
        if (box && box->outside && in) return false;
        if (box && !box->outside) anyInside = true, inOne = inOne || in;
    }
    return !anyInside || inOne;
}

TEST(ClipShapes, KeepWhatTheyShould) {
    ShapeDice dice(7);
    int kept = 0;
    for (int scene = 0; scene < 200; ++scene) {
        const ClipShapes shapes = randomShapes(dice);
        const ClipRegions regions = clipRegions(shapes, {});
        for (int i = 0; i < 50; ++i) {
            const glm::dvec3 p = dice.place(10);
            const bool expected = keptByBruteForce(shapes, p);
            kept += expected;
            EXPECT_EQ(contains(shapes, p), expected);
            EXPECT_EQ(regions.contains(p), expected);
            if (i == 0) {
                EXPECT_EQ(clipRegions(shapes, p).contains({}), expected) << "from another origin";
            }
        }
    }
    EXPECT_GT(kept, 500);
    EXPECT_LT(kept, 9500);
}

TEST(ClipShapes, SayOfBoxesHowMuchIsLeft) {
    ShapeDice dice(11);
    std::array<int, 3> told{};
    for (int scene = 0; scene < 300; ++scene) {
        const ClipRegions regions = clipRegions(randomShapes(dice), {});
        const glm::dvec3 low = dice.place(8), high = low + (dice.place(2) + glm::dvec3(2.01)) * 0.5;
        const Overlap overlap = regions.overlap(low, high);
        ++told[static_cast<std::size_t>(overlap)];
        for (int i = 0; i < 60; ++i) {
            const glm::dvec3 share(dice.between(0, 1), dice.between(0, 1), dice.between(0, 1));
            const bool in = regions.contains(glm::mix(low, high, share));
            EXPECT_FALSE(overlap == Overlap::None && in);
            EXPECT_FALSE(overlap == Overlap::All && !in);
        }
    }
    for (const int count : told) EXPECT_GT(count, 10) << "each of the answers is given";
}

TEST(ClipShapes, FacesBelongToTheirBox) {
    // Decimals that doubles cannot hold, at coordinates of a map: the sum of centre and half size is not the face's double.
    const glm::dvec3 center(444123.15, 5411990.35, 212.05);
    const TurnedBox box{center, {0.1, 0.3, 0.7}};
    const ClipShapes inside{box}, outside{TurnedBox{box.center, box.size, {90, -180, 270}, false}};
    EXPECT_TRUE(contains(inside, {444123.20, 5411990.20, 212.40}));
    EXPECT_TRUE(contains(inside, {444123.10, 5411990.50, 211.70}));
    EXPECT_FALSE(contains(inside, {444123.2000001, 5411990.35, 212.05}));
    EXPECT_TRUE(contains(outside, center));
    for (const double z : {212.39999, 212.4, 212.40001}) {
        TurnedBox other = box;
        other.outside = true;
        const glm::dvec3 p(444123.15, 5411990.35, z);
        EXPECT_NE(contains(inside, p), contains(ClipShapes{other}, p)) << "each point is drawn once";
    }
    EXPECT_TRUE(
        contains(ClipShapes{HalfSpace{{444000, 5411000, 212.1}, {0, 0, 5}}}, {444999.9, 5411999.9, 212.1}));
    EXPECT_FALSE(contains(ClipShapes{HalfSpace{{444000, 5411000, 212.1}, {0, 0, 5}}},
                          {444999.9, 5411999.9, 212.0999}));
}

TEST(ClipShapes, QuartersOfATurnAreExact) {
    const auto axes = axesOf({{}, {1, 1, 1}, {90, 0, 0}});
    EXPECT_EQ(axes[0], glm::dvec3(0, 1, 0)) << "yaw turns +X towards +Y";
    EXPECT_EQ(axes[1], glm::dvec3(-1, 0, 0));
    EXPECT_EQ(axes[2], glm::dvec3(0, 0, 1));
    EXPECT_EQ(axesOf({{}, {1, 1, 1}, {0, 90, 0}})[0], glm::dvec3(0, 0, -1)) << "pitch turns +Z towards +X";
    EXPECT_EQ(axesOf({{}, {1, 1, 1}, {-360, 0, 90}})[1], glm::dvec3(0, 0, 1)) << "roll turns +Y towards +Z";
    EXPECT_EQ(axesOf({{}, {1, 1, 1}, {30, 0, 0}})[2], glm::dvec3(0, 0, 1))
        << "turned about Z, it still is level";
}

TEST(ClipShapes, NoneLeaveEverything) {
    EXPECT_TRUE(contains({}, {1, 2, 3}));
    EXPECT_TRUE(clipRegions({}, {}).empty());
    EXPECT_EQ(clipRegions({}, {}).overlap({0, 0, 0}, {1, 1, 1}), Overlap::All);
}

TEST(ClipShapes, AreWrittenInWords) {
    View view;
    ASSERT_TRUE(applyWord(view, "clips",
                          "box:1,2,3,4,5,6;-box:0,0,0,1,1,1,30;box:0,0,0,1,1,1,1,2,-3;plane:1,2,3,0,0,-1"));
    EXPECT_EQ(view.style.clips,
              (ClipShapes{TurnedBox{{1, 2, 3}, {4, 5, 6}}, TurnedBox{{}, {1, 1, 1}, {30, 0, 0}, true},
                          TurnedBox{{}, {1, 1, 1}, {1, 2, -3}}, HalfSpace{{1, 2, 3}, {0, 0, -1}}}));
    ASSERT_TRUE(applyWord(view, "clips", "auto"));
    EXPECT_TRUE(view.style.clips.empty());
}

TEST(ClipShapes, WrongOnesSayWhatIsWrong) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", "is no shape"},
        {"box:1,2,3,4,5", "6, 7 or 9 numbers"},
        {"box:1,2,3,4,5,6,7,8", "got 8"},
        {"box:1,2,3,4,5,x", "is no number"},
        {"box:0,0,0,1,1,1;", "is no shape"},
        {"sphere:0,0,0,1", "is no shape"},
        {"plane:0,0,0,0,0", "PX,PY,PZ,NX,NY,NZ"},
        {"-plane:0,0,0,0,0,1", "turning its normal round"},
        {"plane:0,0,0,0,0,0", "shape 1, a plane, has the normal 0,0,0"},
        {"plane:0,0,0,0,0,1;box:0,0,0,1,0,1", "shape 2, a box, has a size that is not above 0"},
        {"box:0,0,0,1,1,1,400", "more than 360 degrees"},
        {"box:nan,0,0,1,1,1", "not a finite number"},
        {"box:0,0,0,1,inf,1", "not a finite number"},
        {"plane:0,0,1e13,0,0,1", "beyond 1e12"},
        {"box:0,0,0,1,1,1;box:0,0,0,1,1,1;box:0,0,0,1,1,1;box:0,0,0,1,1,1;box:0,0,0,1,1,1;box:0,0,0,1,1,1;"
         "box:0,0,0,1,1,1;box:0,0,0,1,1,1;box:0,0,0,1,1,1",
         "more than 8 shapes"},
    };
    for (const auto& [text, what] : cases) {
        const auto checked = checkWord("clips", text);
        ASSERT_FALSE(checked) << text;
        EXPECT_EQ(checked.error().field, "clips");
        EXPECT_THAT(checked.error().message, HasSubstr(what)) << text;
    }
}

}  // namespace
}  // namespace scancast
