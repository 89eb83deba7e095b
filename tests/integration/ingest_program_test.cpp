// `scancast ingest` as people run it, and as they interrupt it.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "tests/integration/program_fixture.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {
namespace {

using ::testing::HasSubstr;

class IngestProgram : public ProgramTest {
  protected:
    void generate(const std::string& name, const char* points) {
        ASSERT_EQ(run({"scancast", "generate", "town", "--points", points, "-q", "-o", file(name)}), 0)
            << lastError;
    }
    /// What is in the folder, but for the fixture's own files.
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder))
            if (const auto name = entry.path().filename().string();
                name != "stdout.txt" && name != "stderr.txt")
                names.push_back(name);
        std::sort(names.begin(), names.end());
        return names;
    }
    /// Waits until the program says that it is at this stage.
    static bool reaches(const Process& process, const std::string& stage) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (process.err().find(stage) == std::string::npos) {
            if (std::chrono::steady_clock::now() > end) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return true;
    }
};

TEST_F(IngestProgram, SeveralScansBecomeOneFileThatInfoDescribes) {
    generate("a.las", "30000");
    generate("b.las", "20000");
    ASSERT_EQ(
        run({"scancast", "ingest", file("a.las"), file("b.las"), "-o", file("c.scan"), "--title", "Both"}), 0)
        << lastError;
    EXPECT_THAT(lastError, HasSubstr("50000 points"));
    std::string info;
    ASSERT_EQ(run({"scancast", "info", file("c.scan")}, &info), 0) << lastError;
    EXPECT_THAT(info, HasSubstr("50"));
    EXPECT_THAT(info, HasSubstr("Both"));
    EXPECT_EQ(run({"scancast", "info", "--check", file("c.scan")}), 0) << lastError;
}

TEST_F(IngestProgram, ReadsLasFromStandardInput) {
    generate("a.las", "30000");
    Process process(folder, {"scancast", "ingest", "-", "-o", file("c.scan"), "--title", "a"}, file("a.las"));
    ASSERT_EQ(process.wait(), 0) << process.err();
    ASSERT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("d.scan"), "--title", "a"}), 0)
        << lastError;
    EXPECT_TRUE(contentOf(file("c.scan")) == contentOf(file("d.scan")));
}

TEST_F(IngestProgram, AFileThatIsThereIsReplacedOnRequestOnly) {
    generate("a.las", "1000");
    ASSERT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan")}), 0) << lastError;
    EXPECT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan")}), 1);
    EXPECT_THAT(lastError, HasSubstr("--force"));
    EXPECT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan"), "--force"}), 0);
    EXPECT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("a.las"), "--force"}), 1);
    EXPECT_THAT(lastError, HasSubstr("both input and output"));
}

TEST_F(IngestProgram, WhatWasCutIsReadOnRequestOnlyAndTheCloudSaysSo) {
    generate("a.las", "1000");
    fs::resize_file(file("a.las"), fs::file_size(file("a.las")) / 2);
    EXPECT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan")}), 1);
    EXPECT_THAT(lastError, HasSubstr("its header promises 1,000 points"));
    EXPECT_THAT(lastError, HasSubstr("With --recover"));
    ASSERT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan"), "--recover"}), 0) << lastError;
    EXPECT_THAT(lastError, HasSubstr("a.las: it ends too early: of the 1,000 points that it promises, "));
    std::string info;
    ASSERT_EQ(run({"scancast", "info", file("c.scan")}, &info), 0) << lastError;
    EXPECT_THAT(info, HasSubstr("it ends too early"));
}

TEST_F(IngestProgram, ScansInDifferentSystemsAreNotPutTogetherUnasked) {
    REQUIRE_TEST_DATA("las/permutation-1.0_0.las");
    REQUIRE_TEST_DATA("las/lonlat-pdrf0.las");
    const std::string utm = testData("las/permutation-1.0_0.las"), degrees = testData("las/lonlat-pdrf0.las");
    EXPECT_EQ(run({"scancast", "ingest", utm, degrees, "-o", file("c.scan")}), 1);
    for (const auto& word : {utm, degrees, std::string("EPSG:26915"), std::string("EPSG:4326"),
                             std::string("--assume-crs EPSG:26915")})
        EXPECT_THAT(lastError, HasSubstr(word));
    EXPECT_EQ(files(), std::vector<std::string>()) << "nothing was begun";
    ASSERT_EQ(run({"scancast", "ingest", utm, degrees, "-o", file("c.scan"), "--assume-crs", "EPSG:26915"}),
              0)
        << lastError;
    EXPECT_THAT(lastError, HasSubstr("lonlat-pdrf0.las: it says that it is in "));
    EXPECT_EQ(run({"scancast", "ingest", utm, "-o", file("d.scan"), "--assume-crs", "UTM"}), 1);
    EXPECT_THAT(lastError, HasSubstr("--assume-crs: "));
    std::string look;
    EXPECT_EQ(run({"scancast", "look", utm, "--assume-crs", "EPSG:26915"}, &look), 0) << lastError;
}

TEST_F(IngestProgram, InterruptedItLeavesNothing) {
    generate("a.las", test::sized("1M", "200k"));
    for (const auto& [stage, signal] : {std::pair("reading", SIGINT), {"sorting", SIGHUP}}) {
        Process process(folder, {"scancast", "ingest", file("a.las"), "-o", file("c.scan")});
        ASSERT_TRUE(reaches(process, stage)) << process.err();
        process.signal(signal);
        const int code = process.wait();
        if (code == 0) continue;  // it was done before the signal came
        EXPECT_EQ(code, 1) << process.err();
        EXPECT_THAT(process.err(), HasSubstr("Interrupted"));
        EXPECT_EQ(files(), (std::vector<std::string>{"a.las"})) << stage;
    }
}

TEST_F(IngestProgram, KilledItLeavesNothingThatLooksFinishedAndTheNextRunCleansUp) {
    generate("a.las", test::sized("1M", "200k"));
    {
        Process process(folder, {"scancast", "ingest", file("a.las"), "-o", file("c.scan")});
        ASSERT_TRUE(reaches(process, "sorting")) << process.err();  // long before it ends
        process.signal(SIGKILL);
        process.wait();
    }
    EXPECT_FALSE(fs::exists(file("c.scan")));
    ASSERT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan")}), 0) << lastError;
    EXPECT_EQ(files(), (std::vector<std::string>{"a.las", "c.scan"}));
    EXPECT_EQ(run({"scancast", "info", "--check", file("c.scan")}), 0) << lastError;
}

// Three of them are damaged beside the points alone, which costs no point
// (tests/unit/import/bad_scans_test.cpp).
TEST_F(IngestProgram, DamagedScansAreRefusedWithAReason) {
    REQUIRE_TEST_DATA("bad");
    const std::set<std::string> sound{"bad_vlr_count.las", "malformed_extrabytes.las", "gps-time-nan.las"};
    int refused = 0;
    for (const auto& entry : fs::directory_iterator(testData("bad"))) {
        if (!entry.is_regular_file()) continue;
        const int code = run({"scancast", "ingest", entry.path().string(), "-o", file("c.scan")});
        if (sound.count(entry.path().filename().string()) > 0) {
            EXPECT_EQ(code, 0) << entry.path() << lastError;
            fs::remove(file("c.scan"));
            continue;
        }
        EXPECT_EQ(code, 1) << entry.path() << lastError;
        EXPECT_THAT(lastError, HasSubstr("scancast ingest: ")) << entry.path();
        EXPECT_EQ(files(), std::vector<std::string>{}) << entry.path();
        ++refused;
    }
    EXPECT_GT(refused, 5);
}

TEST_F(IngestProgram, MistakesAreExplained) {
    EXPECT_EQ(run({"scancast", "ingest", file("none.las"), "-o", file("c.scan")}), 1);
    EXPECT_THAT(lastError, HasSubstr("there is no such file"));
    generate("a.las", "1000");
    EXPECT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("no/such/folder/c.scan")}), 1);
    EXPECT_THAT(lastError, HasSubstr("no/such/folder"));
    EXPECT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan"), "--memory-limit", "lots"}), 1);
    EXPECT_THAT(lastError, HasSubstr("--memory-limit 2G"));
    EXPECT_EQ(run({"scancast", "ingest", file("a.las"), "-o", file("c.scan"), "--memory-limit", "1M"}), 1);
    EXPECT_THAT(lastError, HasSubstr("512M"));
}

}  // namespace
}  // namespace scancast::test
