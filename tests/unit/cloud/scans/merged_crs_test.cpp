// Whether scans may become one cloud: every mixture of same, different, unclear and missing systems, near and far. The
// policy is a pure function of what headers say.
#include "renderer/cloud/build/merged_crs.hpp"

#include <gmock/gmock.h>

namespace scancast {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using Box = std::array<glm::dvec3, 2>;

/// A square of a kilometre, so many kilometres east of the first.
Box square(double kilometres) {
    const glm::dvec3 corner(500000 + 1000 * kilometres, 5400000, 100);
    return {corner, corner + glm::dvec3(1000, 1000, 50)};
}

ScanCrs in(int epsg, const char* name, double kilometres = 0) {
    return {.name = name, .epsg = epsg, .bounds = square(kilometres)};
}

ScanCrs called(const std::string& word, const char* name, double kilometres = 0) {
    return {.name = name, .wkt = "PROJCS[\"" + word + "\",UNIT[\"metre\",1]]", .bounds = square(kilometres)};
}

ScanCrs silent(const char* name, double kilometres = 0) {
    return {.name = name, .bounds = square(kilometres)};
}

Expected<MergedCrs> merge(std::vector<ScanCrs> scans) {
    return mergeCrs(scans);
}

void expectRefused(std::vector<ScanCrs> scans, std::vector<const char*> words) {
    const auto merged = mergeCrs(scans);
    ASSERT_FALSE(merged);
    EXPECT_EQ(merged.error().code, ErrorCode::InvalidArgument);
    for (const char* word : words) EXPECT_THAT(merged.error().message, HasSubstr(word));
    EXPECT_THAT(merged.error().message, HasSubstr("--assume-crs"));
    EXPECT_THAT(merged.error().message, HasSubstr("pdal translate"));
}

TEST(MergedCrs, TheSameIsPutTogetherHoweverFarApart) {
    const auto merged =
        merge({in(25832, "a.las"), in(25832, "b.las", 600), called("ETRS89 / UTM zone 32N", "c.las", 5)});
    ASSERT_TRUE(merged) << merged.error().message;
    EXPECT_THAT(merged->notes, IsEmpty());
    EXPECT_EQ(merged->epsg, 25832);
    EXPECT_THAT(merged->wkt, HasSubstr("UTM zone 32N")) << "what the first leaves out, another says";
    EXPECT_FALSE(merged->boundsMatter);
}

TEST(MergedCrs, DifferentIsRefusedHoweverNear) {
    expectRefused(
        {in(25832, "a.las"), in(25832, "b.las"), in(25833, "c.las")},
        {"a.las is in ETRS89 / UTM zone 32N (EPSG:25832), c.las in ETRS89 / UTM zone 33N (EPSG:25833)",
         "--assume-crs EPSG:25832",
         "pdal translate c.las c-reprojected.las reprojection --filters.reprojection.out_srs=EPSG:25832"});
    expectRefused({in(25832, "a.las"), in(4326, "b.las")}, {"a.las", "b.las", "EPSG:4326"});
    expectRefused({silent("s.las"),
                   called("Grid", "a.las"),
                   {.name = "b.las", .wkt = "PROJCS[\"Grid\",UNIT[\"foot\",0.3048]]"}},
                  {"a.las", "b.las", "Grid", "EPSG:NUMBER"});
}

TEST(MergedCrs, MissingIsToldWhereItIsNear) {
    const auto merged = merge({silent("a.xyz"), in(25832, "b.las", 1), silent("c.xyz", 50)});
    ASSERT_TRUE(merged) << merged.error().message;
    EXPECT_EQ(merged->epsg, 25832);
    EXPECT_THAT(
        merged->notes,
        ElementsAre("a.xyz and c.xyz do not say their coordinate reference system; that of b.las, ETRS89 / "
                    "UTM zone 32N (EPSG:25832), is taken for them"));
    // Notes are read by people who need not know the folders of this machine.
    const auto one = merge({in(25832, "/scans/b.las"), silent("/scans/secret/a.xyz")});
    EXPECT_THAT(one->notes,
                ElementsAre(StartsWith("a.xyz does not say its coordinate reference system; that of b.las")));
    const auto many =
        merge({in(25832, "b.las"), silent("1"), silent("2"), silent("3"), silent("4"), silent("5")});
    EXPECT_THAT(many->notes, ElementsAre(HasSubstr("1, 2, 3 and 2 more do not say")));
}

TEST(MergedCrs, MissingAndFarIsRefused) {
    expectRefused({in(25832, "a.las"), silent("b.xyz", 600)},
                  {"b.xyz does not say", "lies 599 km from a.las", "EPSG:25832", "in_srs=EPSG:NUMBER"});
    // Coordinates of the scanner, beside those of a map.
    expectRefused(
        {in(25832, "a.las"), {.name = "room.ply", .bounds = Box{glm::dvec3(-5, -5, 0), glm::dvec3(5, 5, 3)}}},
        {"room.ply", "5423 km"});
    // Degrees count as what they are on the ground: two of them are over 200 km.
    const auto degrees = [](double longitude) {
        return Box{glm::dvec3(longitude, 48, 0), glm::dvec3(longitude + 0.01, 48.01, 100)};
    };
    expectRefused(
        {{.name = "a.las", .epsg = 4326, .bounds = degrees(9)}, {.name = "b.las", .bounds = degrees(11)}},
        {"221 km"});
    EXPECT_TRUE(merge(
        {{.name = "a.las", .epsg = 4326, .bounds = degrees(9)}, {.name = "b.las", .bounds = degrees(9.5)}}));
}

TEST(MergedCrs, FarIsMeasuredByTheScansThemselves) {
    // 150 km lie between scans that are 20 km long each: more than 100 km, and not more than ten lengths.
    auto a = in(25832, "a.las"), b = silent("b.xyz", 170);
    a.bounds->at(1).x += 19000;
    EXPECT_TRUE(merge({a, b}));
    a.bounds->at(1).x -= 10000;
    EXPECT_FALSE(merge({a, b}));
    // One that is near one that is near is near: a flight line of tiles, of which one says what they are.
    std::vector<ScanCrs> tiles{in(25832, "0.las")};
    for (int i = 1; i < 12; ++i) tiles.push_back(silent("tile.xyz", 90.0 * i));
    EXPECT_TRUE(mergeCrs(tiles));
    std::ranges::reverse(tiles);
    EXPECT_TRUE(mergeCrs(tiles)) << "in any order";
    tiles.erase(tiles.begin() + 5);
    EXPECT_FALSE(mergeCrs(tiles)) << "a gap";
}

TEST(MergedCrs, NobodySaysAnything) {
    const auto near = merge({silent("a.ply"), silent("b.ply", 1)});
    ASSERT_TRUE(near);
    EXPECT_THAT(near->notes, IsEmpty());
    EXPECT_EQ(near->epsg, std::nullopt);
    expectRefused({silent("a.ply"), silent("b.ply", 600)}, {"a.ply and b.ply do not say", "599 km"});
}

TEST(MergedCrs, UnclearIsToldOrRefused) {
    const auto near = merge({called("Site grid", "a.las"), called("Plant grid", "b.las", 2)});
    ASSERT_TRUE(near) << near.error().message;
    EXPECT_THAT(
        near->notes,
        ElementsAre("a.las is in Site grid, b.las in Plant grid; nothing proves that these are the same, and "
                    "they are taken for it"));
    expectRefused({called("Site grid", "a.las"), called("Plant grid", "b.las", 600)},
                  {"a.las is in Site grid, b.las in Plant grid", "599 km"});
    // Hundreds of spellings do not make hundreds of notes.
    std::vector<ScanCrs> scans;
    for (int i = 0; i < 300; ++i)
        scans.push_back(called("Grid number " + std::to_string(i) + " of a plant", "x.las"));
    ASSERT_EQ(mergeCrs(scans)->notes.size(), 6U);
    EXPECT_THAT(mergeCrs(scans)->notes.back(), HasSubstr("294 more coordinate reference systems"));
}

TEST(MergedCrs, BoundsThatSayNothingAreNotBelieved) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& bounds : {std::optional<Box>(), std::optional(Box{glm::dvec3(0), glm::dvec3(0)}),
                               std::optional(Box{glm::dvec3(nan), glm::dvec3(1)}),
                               std::optional(Box{glm::dvec3(2), glm::dvec3(1)})}) {
        const ScanCrs strange{.name = "b.las", .bounds = bounds};
        EXPECT_FALSE(hasPlace(strange));
        const auto merged = merge({in(25832, "a.las"), strange});
        ASSERT_TRUE(merged) << merged.error().message;
        EXPECT_EQ(merged->notes.size(), 1U);
        EXPECT_TRUE(merged->boundsMatter) << "when it is read, it will be seen where it lies";
    }
    EXPECT_FALSE(merge({in(25832, "a.las"), {.name = "b.las", .epsg = 25832}})->boundsMatter);
    EXPECT_FALSE(merge({in(25832, "a.las"), silent("b.las")})->boundsMatter);
}

TEST(MergedCrs, OneScanIsItself) {
    const auto merged = merge({in(25832, "a.las")});
    ASSERT_TRUE(merged);
    EXPECT_EQ(merged->epsg, 25832);
    EXPECT_THAT(merged->notes, IsEmpty());
}

}  // namespace
}  // namespace scancast
