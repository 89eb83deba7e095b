// The word `with`: several clouds in one view.
#include <gmock/gmock.h>

#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

using testing::HasSubstr;

std::string many(std::size_t clouds) {
    std::string text = "a";
    for (std::size_t i = 1; i < clouds; ++i) text += ";a";
    return text;
}

TEST(ViewedClouds, AreWrittenInWords) {
    View view;
    ASSERT_TRUE(applyWord(view, "with", "town-2024,hidden,shift:-1:0.5:1e-2;.,tint:ff8000;c,tint:#010203"));
    EXPECT_EQ(view.with, (ViewedClouds{{"town-2024", {-1, 0.5, 0.01}, std::nullopt, true},
                                       {".", {}, Rgb8{255, 128, 0}, false},
                                       {"c", {}, Rgb8{1, 2, 3}, false}}));
    ASSERT_TRUE(applyWord(view, "with", "folder/scan 1.scan")) << "scancast render names files";
    EXPECT_EQ(view.with.front().cloud, "folder/scan 1.scan");
    ASSERT_TRUE(applyWord(view, "with", "auto"));
    EXPECT_TRUE(view.with.empty());
    EXPECT_TRUE(checkWord("with", many(mostViewedClouds)));
    EXPECT_TRUE(checkWord("with", "a;a,shift:1:1:1")) << "one cloud in two places";
}

TEST(ViewedClouds, WrongOnesSayWhatIsWrong) {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", "no name"},
        {"a;", "no name"},
        {",hidden", "no name"},
        {"a,", "says nothing of a cloud"},
        {"a,shown", "says nothing of a cloud"},
        {"a,shift:1:2", "DX:DY:DZ"},
        {"a,shift:1:2:x", "DX:DY:DZ"},
        {"a,shift:1,2,3", "DX:DY:DZ"},
        {"a,shift:1:2:nan", "not a finite number"},
        {"a,shift:1:2:1e13", "beyond 1e12"},
        {"a,shift:1:2:3,shift:1:2:3", "said twice"},
        {"a,tint:red", "is no colour"},
        {"a,tint:010203,tint:010203", "said twice"},
        {"a,hidden,hidden", "said twice"},
        {".;a;.,hidden", "stands there twice"},
        {std::string(longestCloudName + 1, 'a'), "is no cloud's name"},
        {"a\x01", "is no cloud's name"},
        {many(mostViewedClouds + 1), "more than 64 clouds"},
    };
    for (const auto& [text, what] : cases) {
        const auto checked = checkWord("with", text);
        ASSERT_FALSE(checked) << text;
        EXPECT_EQ(checked.error().field, "with");
        EXPECT_THAT(checked.error().message, HasSubstr(what)) << text;
    }
}

}  // namespace
}  // namespace scancast
