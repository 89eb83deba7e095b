#include "renderer/method/method.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
    return m.passes(m, resolveParameters(m, given).value(), shading);
}

NearestPass nearest(const char* name, const ParameterValues& given) {
    return std::get<NearestPass>(passes(name, given).front());
}

TEST(Methods, AreTheSixSprites) {
    std::vector<std::string> names;
    for (const Method& m : methods()) names.push_back(m.name);
    EXPECT_THAT(names, ElementsAre("paraboloid", "cone", "sphere", "circle", "square", "point"));
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

TEST(Methods, EndWithTheScreenPassesOfTheShading) {
    for (const Method& m : methods()) {
        const PassList unlit = passes(m.name.c_str(), {});
        ASSERT_EQ(unlit.size(), 2u) << m.name;
        EXPECT_TRUE(std::holds_alternative<NearestPass>(unlit[0]));
        EXPECT_TRUE(std::holds_alternative<ResolvePass>(unlit[1]));
        const PassList lit = passes(m.name.c_str(), {}, Shading::EyeDome);
        ASSERT_EQ(lit.size(), 3u) << m.name;
        EXPECT_TRUE(std::holds_alternative<EyeDomePass>(lit[2]));
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
