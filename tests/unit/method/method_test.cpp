#include "renderer/method/method.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

namespace scancast {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Method& method(const char* name) {
    return *findMethod(name);
}

PassList passes(const char* name, const ParameterValues& given, Shading shading = Shading::Unlit) {
    const Method& m = method(name);
    return m.passes({m, resolveParameters(m, given).value(), shading});
}

NearestPass nearest(const char* name, const ParameterValues& given) {
    return std::get<NearestPass>(passes(name, given).front());
}

TEST(Methods, BeginWithTheSixSprites) {
    std::vector<std::string> names;
    for (const Method& m : methods()) names.push_back(m.name);
    ASSERT_GE(names.size(), 6u);
    EXPECT_THAT(std::vector(names.begin(), names.begin() + 6),
                ElementsAre("paraboloid", "cone", "sphere", "circle", "square", "point"));
    EXPECT_EQ(std::set(names.begin(), names.end()).size(), names.size()) << "every name once";
    EXPECT_EQ(findMethod("voronoy"), nullptr);
    EXPECT_EQ(findMethod(""), nullptr);
}

TEST(Methods, DescribeThemselvesAndHaveLegalDefaults) {
    for (const Method& m : methods()) {
        EXPECT_FALSE(m.title.empty() || m.summary.empty() || m.source.empty()) << m.name;
        const auto values = resolveParameters(m, {});
        ASSERT_TRUE(values) << values.error().message;
        EXPECT_EQ(values->size(), m.parameters.size());
        std::set<std::string> seen;
        for (const Parameter& p : m.parameters) {
            EXPECT_TRUE(seen.insert(p.name).second) << p.name;
            EXPECT_FALSE(p.meaning.empty()) << p.name;
            if (p.type == Parameter::Type::Number) {
                EXPECT_LT(p.min, p.max) << p.name;
            }
        }
    }
}

TEST(Methods, PyramidTakesItsGapFromTheNoise) {
    const auto gap = [](const ParameterValues& given, double measured) {
        const Method& m = method("pyramid");
        const ParameterValues values = resolveParameters(m, given).value();
        CloudTraits cloud;
        cloud.spacing = 0.5;
        cloud.noise = measured;
        const PassList list = m.passes({.method = m, .values = values, .cloud = cloud});
        return std::get<HiddenPointsPass>(list[2]).minGap;
    };
    EXPECT_EQ(gap({}, 0), 0);
    EXPECT_FLOAT_EQ(gap({}, 0.1), 0.3f);
    EXPECT_FLOAT_EQ(gap({{"noise", 0.2}}, 0.1), 0.6f);
    EXPECT_EQ(gap({{"minGap", 0.0}}, 0.1), 0);
    EXPECT_FLOAT_EQ(gap({{"minGap", 2.0}, {"noise", 0.2}}, 0.1), 2);
}

TEST(Methods, EndWithTheScreenPassesOfTheShading) {
    for (const Method& m : methods()) {
        const PassList unlit = passes(m.name.c_str(), {});
        EXPECT_FALSE(std::holds_alternative<PhongPass>(unlit.back()))
            << m.name << ": unlit, its list must not end with a pass of light";
        EXPECT_FALSE(std::holds_alternative<EyeDomePass>(unlit.back()))
            << m.name << ": unlit, its list must not end with a pass of light";
        const PassList dome = passes(m.name.c_str(), {}, Shading::EyeDome);
        EXPECT_TRUE(std::holds_alternative<EyeDomePass>(dome.back())) << m.name;
        EXPECT_EQ(dome.size(), unlit.size() + 1) << m.name;
        const PassList phong = passes(m.name.c_str(), {}, Shading::Phong);
        EXPECT_TRUE(std::holds_alternative<PhongPass>(phong.back())) << m.name;
        for (const Shading shading : {Shading::Unlit, Shading::Phong, Shading::EyeDome}) {
            const auto values = resolveParameters(m, {}).value();
            PassRequest request{m, values, shading};
            request.light.occlusion = 0.5;
            request.height = 360;
            const PassList hollow = m.passes(request);
            ASSERT_TRUE(std::holds_alternative<OcclusionPass>(hollow.back())) << m.name;
            request.light.sun = {{135, 40}};
            request.light.shadow = 1;
            const PassList shaded = m.passes(request);
            EXPECT_TRUE(std::ranges::any_of(shaded, [](const Pass& p) {
                return std::holds_alternative<ShadowPass>(p);
            })) << m.name;
            EXPECT_EQ(std::get<OcclusionPass>(hollow.back()).radiusPx, 18) << "of the picture's height";
        }
    }
}

TEST(Methods, OfSpritesAreOneSplatPass) {
    for (const Method& m : methods().first(6)) {
        const PassList unlit = passes(m.name.c_str(), {});
        ASSERT_EQ(unlit.size(), 2u) << m.name;
        EXPECT_TRUE(std::holds_alternative<NearestPass>(unlit[0]));
        EXPECT_TRUE(std::holds_alternative<ResolvePass>(unlit[1]));
    }
}

TEST(Methods, PassParametersOn) {
    const NearestPass p =
        nearest("paraboloid", {{"sizePx", 5.0}, {"gain", 1.5}, {"footprint", std::string("square")}});
    EXPECT_EQ(p.footprint, Footprint::Square);
    EXPECT_EQ(p.profile, Profile::Paraboloid);
    EXPECT_EQ(p.size.sizePx, 5);
    EXPECT_EQ(p.gain, 1.5f);
    const NearestPass c = nearest("circle", {{"scale", 3.0}, {"minPx", 8.0}, {"maxPx", 4.0}});
    EXPECT_EQ(c.footprint, Footprint::Circle);
    EXPECT_EQ(c.profile, Profile::Flat);
    EXPECT_EQ(c.size.scale, 3);
    EXPECT_GE(c.size.maxPx, c.size.minPx) << "a clamp needs ordered ends";
    EXPECT_EQ(nearest("point", {}).footprint, Footprint::Pixel);
    EXPECT_EQ(nearest("sphere", {}).profile, Profile::Sphere);
    EXPECT_EQ(nearest("cone", {}).gain, 2);
}

TEST(Methods, SmoothBordersOfParaboloidsWhereAPixelHasOneSample) {
    const Method& m = method("paraboloid");
    const auto listed = [&](bool smooth, int samples) {
        const ParameterValues values = resolveParameters(m, {{"smooth", smooth}}).value();
        PassRequest request{m, values};
        request.samples = samples;
        return m.passes(request);
    };
    const PassList smooth = listed(true, 1);
    EXPECT_TRUE(std::get<ResolvePass>(smooth[1]).smooth);
    EXPECT_EQ(std::get<NearestPass>(smooth[0]).payload, Payload::Sample) << "whose cell a pixel shows";
    for (const auto& [wanted, samples] : {std::pair{false, 1}, {true, 2}, {true, 4}, {false, 4}}) {
        const PassList list = listed(wanted, samples);
        EXPECT_FALSE(std::get<ResolvePass>(list[1]).smooth) << samples;
        EXPECT_EQ(std::get<NearestPass>(list[0]).payload, Payload::Color) << samples;
    }
    EXPECT_FALSE(std::get<bool>(resolveParameters(m, {}).value().at("smooth"))) << "not without being asked";
    for (const char* other : {"cone", "sphere", "circle"})
        EXPECT_FALSE(resolveParameters(method(other), {{"smooth", true}})) << other;
}

template <class P>
const P* find(const PassList& list) {
    for (const Pass& pass : list) {
        if (const P* found = std::get_if<P>(&pass)) return found;
    }
    return nullptr;
}

TEST(Methods, OfSurfelsNeedSurfelsAndAreLit) {
    for (const char* name : {"disc", "ewa", "voronoi"}) {
        EXPECT_EQ(method(name).needs, Needs::Surfels) << name;
        EXPECT_EQ(method(name).defaultShading, Shading::Phong) << name;
        EXPECT_EQ(method(name).defaultDetail, 2) << name;
        const PassList lit = passes(name, {{"scale", 1.5}, {"cull", false}}, Shading::Phong);
        const NearestPass& pass = *find<NearestPass>(lit);
        EXPECT_EQ(pass.size.scale, 1.5f) << name;
        EXPECT_EQ(pass.facing, Facing::Any) << name;
        const bool summed = find<SumPass>(lit) != nullptr && find<SumPass>(lit)->normals;
        EXPECT_TRUE(summed || pass.payload == Payload::Sample) << name << ": light needs normals";
        EXPECT_TRUE(find<ResolvePass>(lit)->normals) << name;
        EXPECT_EQ(find<NearestPass>(passes(name, {}))->facing, Facing::Front) << name;
    }
}

TEST(Methods, EllipsesAreBlendedDiscsAreNot) {
    EXPECT_EQ(find<NearestPass>(passes("disc", {}))->footprint, Footprint::Disc);
    EXPECT_EQ(find<SumPass>(passes("disc", {})), nullptr);
    const PassList ewa = passes("ewa", {{"lowPass", 0.75}}, Shading::Phong);
    EXPECT_EQ(find<NearestPass>(ewa)->footprint, Footprint::Ellipse);
    EXPECT_EQ(find<NearestPass>(ewa)->lowPassPx, 0.75f);
    EXPECT_EQ(find<SumPass>(ewa)->lowPassPx, 0.75f);
    EXPECT_TRUE(find<SumPass>(ewa)->normals);
    EXPECT_TRUE(find<ResolvePass>(ewa)->sums);
    EXPECT_FALSE(find<NearestPass>(ewa)->round || find<SumPass>(ewa)->round);
    const PassList circles = passes("ewa", {{"shape", std::string("circle")}});
    EXPECT_TRUE(find<NearestPass>(circles)->round && find<SumPass>(circles)->round);
}

TEST(Methods, PyramidLooksEquallyFarEverywhereWhereAsked) {
    EXPECT_EQ(find<HiddenPointsPass>(passes("pyramid", {}))->fixedPx, 0);
    EXPECT_EQ(find<HiddenPointsPass>(passes("pyramid", {{"hprPx", 40.0}}))->fixedPx, 40);
}

TEST(Methods, VoronoiListsThePassesOfItsPaperInOrder) {
    const PassList flat = passes("voronoi", {{"smooth", false}, {"tolerance", 0.5}});
    ASSERT_EQ(flat.size(), 3u);
    EXPECT_TRUE(std::holds_alternative<NearestPass>(flat[0]));
    EXPECT_EQ(std::get<CellPass>(flat[1]).tolerance, 0.5f);
    EXPECT_FALSE(std::get<ResolvePass>(flat[2]).sums);
    const PassList all = passes("voronoi", {{"silhouette", true}});
    ASSERT_EQ(all.size(), 5u);
    EXPECT_EQ(std::get<SilhouettePass>(all[0]).facing, Facing::Back);
    EXPECT_EQ(std::get<CellPass>(all[2]).tolerance, 1);
    EXPECT_EQ(std::get<SumPass>(all[3]).reach, 2);
    EXPECT_TRUE(std::get<ResolvePass>(all[4]).sums);
}

TEST(ResolveParameters, RefusesWhatIsOutOfRangeAndNamesTheRange) {
    for (const double bad : {-1.0, 257.0, 1e9, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
        const auto result = resolveParameters(method("paraboloid"), {{"sizePx", bad}});
        ASSERT_FALSE(result) << bad;
        EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
        EXPECT_EQ(result.error().field, "param.sizePx");
        EXPECT_THAT(result.error().message, HasSubstr("from 0 to 256 px"));
    }
    EXPECT_FALSE(resolveParameters(method("cone"), {{"scale", 0.0}})) << "a splat of no size at all";
}

TEST(ResolveParameters, RefusesTheWrongType) {
    EXPECT_FALSE(resolveParameters(method("cone"), {{"gain", true}}));
    EXPECT_FALSE(resolveParameters(method("cone"), {{"gain", std::string("2")}}));
    EXPECT_FALSE(resolveParameters(method("cone"), {{"footprint", 1.0}}));
    const auto choice = resolveParameters(method("cone"), {{"footprint", std::string("hexagon")}});
    ASSERT_FALSE(choice);
    EXPECT_THAT(choice.error().message, HasSubstr("circle or square, not"));
}

TEST(ResolveParameters, NamesTheNearestKnownParameter) {
    const auto result = resolveParameters(method("paraboloid"), {{"sizepx", 5.0}});
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().field, "param.sizepx");
    EXPECT_THAT(result.error().message, HasSubstr("did you mean sizePx?"));
    const auto none = resolveParameters(method("point"), {{"scale", 2.0}});
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().message, HasSubstr("takes no parameters"));
}

TEST(ResolveParameters, SurvivesHostileNames) {
    const std::string longName(100000, 'x');
    const auto result = resolveParameters(method("paraboloid"), {{longName, 1.0}});
    ASSERT_FALSE(result);
    EXPECT_LT(result.error().message.size() + result.error().field.size(), 400u);
    EXPECT_FALSE(resolveParameters(method("paraboloid"), {{std::string("a\nb\0c", 5), 1.0}}));
    EXPECT_FALSE(resolveParameters(method("paraboloid"), {{"", 1.0}}));
}

}  // namespace
}  // namespace scancast
