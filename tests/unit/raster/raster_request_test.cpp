#include "protocol/raster/raster_request.hpp"

#include <gtest/gtest.h>

namespace scancast::test {
namespace {

Error refusalOf(RasterKind kind, const WordValues& words) {
    const auto request = rasterRequestOf(kind, words);
    EXPECT_FALSE(request);
    return request ? Error{} : request.error();
}

TEST(RasterRequest, WordsComeBackAsTheyMean) {
    const WordValues words{{"bbox", "1,2,3.5,4"}, {"cell", "0.25"}, {"value", "mean"}, {"fill", "3"},
                           {"compress", "none"},  {"tile", "512"},  {"classes", "2,6"}};
    const auto request = rasterRequestOf(RasterKind::Elevation, words);
    ASSERT_TRUE(request) << request.error().message;
    EXPECT_EQ(*request->bbox, (std::array<double, 4>{1, 2, 3.5, 4}));
    EXPECT_EQ(*request->cell, 0.25);
    EXPECT_EQ(request->value, CellValue::Mean);
    EXPECT_EQ(request->fill, 3);
    EXPECT_EQ(request->packing, RasterPacking::None);
    EXPECT_EQ(request->tile, 512);
    const auto again = rasterRequestOf(RasterKind::Elevation, wordsOf(*request));
    ASSERT_TRUE(again);
    EXPECT_EQ(wordsOf(*again), wordsOf(*request));
    EXPECT_TRUE(wordsOf(*rasterRequestOf(RasterKind::Orthophoto, {})).empty());
}

TEST(RasterRequest, EveryWordSaysWhatItMustBe) {
    const std::vector<std::pair<std::string, std::string>> wrong{{"bbox", "1,2,3"},
                                                                 {"bbox", "3,2,1,4"},
                                                                 {"bbox", "a,2,3,4"},
                                                                 {"cell", "0"},
                                                                 {"cell", "-1"},
                                                                 {"cell", "nan"},
                                                                 {"cell", "inf"},
                                                                 {"bbox", "-inf,-inf,inf,inf"},
                                                                 {"bbox", "-1e308,-1e308,1e308,1e308"},
                                                                 {"cell", "1e999"},
                                                                 {"value", "median"},
                                                                 {"fill", "-1"},
                                                                 {"fill", "65"},
                                                                 {"fill", "1.5"},
                                                                 {"tile", "300"},
                                                                 {"compress", "lzw"}};
    for (const auto& [word, text] : wrong) {
        const Error error = refusalOf(RasterKind::Elevation, {{word, text}});
        EXPECT_EQ(error.field, word) << text;
        EXPECT_TRUE(error.message.starts_with(word + ": ")) << error.message;
    }
    for (const RasterWord& word : rasterWords())
        EXPECT_TRUE(
            rasterRequestOf(RasterKind::Elevation, {{std::string(word.word), std::string(word.example)}}))
            << word.word;
}

TEST(RasterRequest, WordsThatMeanNothingAreRefusedNotDropped) {
    EXPECT_EQ(refusalOf(RasterKind::Elevation, {{"color", "rgb"}}).field, "color");
    EXPECT_EQ(refusalOf(RasterKind::Elevation, {{"eye", "1,2,3"}}).field, "eye");
    EXPECT_EQ(refusalOf(RasterKind::Orthophoto, {{"eye", "1,2,3"}}).field, "eye");
    EXPECT_EQ(refusalOf(RasterKind::Orthophoto, {{"width", "100"}}).field, "width");
    EXPECT_EQ(refusalOf(RasterKind::Orthophoto, {{"fill", "2"}}).field, "fill");
    EXPECT_NE(refusalOf(RasterKind::Elevation, {{"with", "other"}}).message.find("one cloud at a time"),
              std::string::npos);
    EXPECT_EQ(refusalOf(RasterKind::Elevation, {{"cell", "1"}, {"cell", "2"}}).field, "cell");
    EXPECT_NE(refusalOf(RasterKind::Elevation, {{"cel", "1"}}).message.find("cell"), std::string::npos);
    EXPECT_TRUE(rasterRequestOf(RasterKind::Orthophoto,
                                {{"method", "ewa"}, {"param.scale", "2"}, {"color", "elevation"}}));
}

}  // namespace
}  // namespace scancast::test
