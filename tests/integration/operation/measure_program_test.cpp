// Picks and measurements on their whole way: a scan on disk, the server, scancast-client. The scan is a plate of 10 x 10 at height 2, so
// that all numbers are known.
#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>

#include "tests/integration/program_fixture.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class MeasureProgram : public ProgramTest {
  protected:
    void SetUp() override {
        ProgramTest::SetUp();
        std::string text;
        for (int i = 0; i <= 100; ++i)
            for (int j = 0; j <= 100; ++j)
                text += std::to_string(i * 0.1) + " " + std::to_string(j * 0.1) + " 2\n";
        folder.write("plate.xyz", text);
        server_ = serve({file("plate.xyz")});
    }
    json asked(std::vector<std::string> words) {
        words.insert(words.begin(), "scancast-client");
        words.push_back("--json");
        std::string out;
        EXPECT_EQ(run(words, &out), 0) << lastError;
        return json::parse(out, nullptr, false);
    }

  private:
    std::unique_ptr<Process> server_;
};

TEST_F(MeasureProgram, TellsWhatTheProtocolTells) {
    const json point = asked({"pick", url, "plate", "--x", "320", "--y", "240", "--eye", "5,5,12", "--target",
                              "5,5,2", "--up", "0,1,0", "--width", "640", "--height", "480"});
    ASSERT_TRUE(point.contains("precision") && point.contains("attributes")) << point;
    // Texts have no grid: a point is told as near as its leaf keeps it, which is said beside it.
    constexpr std::array place{5.0, 5.0, 2.0};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_LT(point["precision"][axis].get<double>(), 0.001);
        EXPECT_NEAR(point["position"][axis].get<double>(), place[axis],
                    point["precision"][axis].get<double>());
    }
    EXPECT_EQ(asked({"pick", url, "plate", "--x", "0", "--y", "0", "--eye", "5,5,12", "--target", "5,5,2",
                     "--up", "0,1,0", "--projection", "orthographic", "--view-height", "100"}),
              nullptr);
    const json volume = asked({"measure", url, "volume", "plate", "--point", "1,1", "--point", "9,1",
                               "--point", "9,9", "--point", "1,9", "--base", "-1"});
    EXPECT_NEAR(volume["above"].get<double>(), 64 * 3, 1e-6);
    EXPECT_EQ(volume["holes"], 0);
    std::string out;
    EXPECT_EQ(
        run({"scancast-client", "measure", url, "distance", "--point", "0,0,0", "--point", "3,4,0"}, &out), 0)
        << lastError;
    EXPECT_THAT(out, HasSubstr("\nlength                   5.0\n"));
}

TEST_F(MeasureProgram, WrongWordsAreSaidBeforeAnybodyIsAsked) {
    EXPECT_EQ(run({"scancast-client", "measure", url, "weight", "--point", "0,0,0"}), 2);
    EXPECT_EQ(run({"scancast-client", "measure", url, "distance", "--point", "0,zero"}), 2);
    EXPECT_EQ(run({"scancast-client", "measure", url, "distance", "--point", "0,0,0"}), 1);
    EXPECT_THAT(lastError, HasSubstr("two vertices at least"));
    EXPECT_EQ(run({"scancast-client", "measure", url, "cylinder", "--point", "50,50,0", "--within", "1"}), 1);
    EXPECT_THAT(lastError, HasSubstr("none of the scan's points"));
}

}  // namespace
}  // namespace scancast::test
