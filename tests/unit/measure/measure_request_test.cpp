// What may be asked, and what is said to who asks otherwise.
#include "protocol/measure/measure_request.hpp"

#include <gtest/gtest.h>

#include "protocol/json_text.hpp"

namespace scancast::test {
namespace {

TEST(MeasureRequest, PrintsWhatItReads) {
    for (
        const char* text : {
            R"({"measure": "distance", "points": [[0, 0, 0], [1, 2, 3]]})",
            R"({"measure": "volume", "points": [[0, 0], [1, 0], [1, 1.5]], "base": 34.5, "cell": 0.25})",
            R"({"measure": "volume", "points": [[0, 0, 1], [1, 0, 1], [1, 1, 2]], "base": "fit", "surface": "mean",
                 "view": {"classes": [6]}})",
            R"({"measure": "circle", "points": [[0, 0, 1]], "within": 0.5, "axis": [0, 0, 2]})",
            R"({"measure": "circle", "points": [[0, 0, 1], [1, 0, 1], [0, 1, 1]]})",
            R"({"measure": "cylinder", "points": [[0, 0, 1]], "within": 2, "view": {"clip": null}})",
        }) {
        const auto request = parseMeasureRequest(text);
        ASSERT_TRUE(request) << text << request.error().message;
        const auto again = parseMeasureRequest(printJson(toJson(*request)));
        ASSERT_TRUE(again) << text << again.error().message;
        EXPECT_EQ(printJson(toJson(*again)), printJson(toJson(*request)));
    }
    EXPECT_EQ(parseMeasureRequest(R"({"measure": "volume", "points": [[0,0,0],[1,0,0],[0,1,0]]})")->base,
              VolumeBase::Lowest);
}

TEST(MeasureRequest, ErrorsNameTheField) {
    const std::pair<const char*, const char*> wrong[] = {
        {R"({"points": [[0, 0, 0], [1, 2, 3]]})", "measure"},
        {R"({"measure": "weight", "points": [[0, 0, 0]]})", "measure"},
        {R"({"measure": "distance"})", "points"},
        {R"({"measure": "distance", "points": []})", "points"},
        {R"({"measure": "distance", "points": [[0, 0, 0]]})", "points"},
        {R"({"measure": "distance", "points": [[0, 0, 0], [1, 2]]})", "points[1]"},
        {R"({"measure": "distance", "points": [[0, 0, 0], [1, 2, 1e13]]})", "points[1]"},
        {R"({"measure": "distance", "points": [[0, 0, 0], [1, 2, "3"]]})", "points[1]"},
        {R"({"measure": "distance", "points": [[0, 0, 0], [1, 2, 3]], "cell": 1})", "cell"},
        {R"({"measure": "distance", "points": [[0, 0, 0], [1, 2, 3]], "view": {}})", "view"},
        {R"({"measure": "volume", "points": [[0, 0], [1, 0], [1, 1]]})", "points[0]"},
        {R"({"measure": "volume", "points": [[0,0,0],[1,0,0],[1,1,0]], "base": "highest"})", "base"},
        {R"({"measure": "volume", "points": [[0,0,0],[1,0,0],[1,1,0]], "base": true})", "base"},
        {R"({"measure": "volume", "points": [[0,0,0],[1,0,0],[1,1,0]], "cell": 0})", "cell"},
        {R"({"measure": "volume", "points": [[0,0,0],[1,0,0],[1,1,0]], "within": 1})", "within"},
        {R"({"measure": "volume", "points": [[0,0,0],[1,0,0],[1,1,0]], "surface": "low"})", "surface"},
        {R"({"measure": "circle", "points": [[0,0,0],[1,0,0]]})", "points"},
        {R"({"measure": "circle", "points": [[0,0,0]], "within": 1, "axis": [0, 0, 0]})", "axis"},
        {R"({"measure": "cylinder", "points": [[0,0,0],[1,0,0],[0,1,0]]})", "within"},
        {R"({"measure": "plane", "points": [[0,0,0]]})", "points"},
        {R"({"measure": "plane", "points": [[0,0,0]], "within": -1})", "within"},
    };
    for (const auto& [text, field] : wrong) {
        const auto request = parseMeasureRequest(text);
        ASSERT_FALSE(request) << text;
        EXPECT_EQ(request.error().code, ErrorCode::InvalidArgument) << text;
        EXPECT_EQ(request.error().field, field) << text << request.error().message;
    }
    EXPECT_EQ(parseMeasureRequest("{").error().code, ErrorCode::Malformed);
}

TEST(MeasureRequest, ErrorsOfVolumesTellOfAllThatABaseMayBe) {
    const auto messageOf = [](const char* text) { return parseMeasureRequest(text).error().message; };
    EXPECT_NE(messageOf(R"({"measure": "volume", "points": [[0,0,0],[1,0,0],[1,1,0]], "base": "1e"})")
                  .find("a height, or lowest, mean or fit"),
              std::string::npos);
    EXPECT_NE(messageOf(R"({"measure": "volume", "points": [[0,0],[1,0],[1,1]], "base": "fit"})")
                  .find("two are enough over a base that is a height"),
              std::string::npos);
}

}  // namespace
}  // namespace scancast::test
