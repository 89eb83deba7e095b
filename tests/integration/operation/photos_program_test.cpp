// Photos of a scan, from the scanner's file to who asks for them, as people run it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/program_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

using PhotosProgram = ProgramTest;

/// Bytes of a blob in an E57 file, by the standard's pages: 1020 bytes and a checksum each. `at`: the section's offset in the file, as
/// its XML says; 16 bytes of head.
std::string blob(const std::string& e57, std::size_t at, std::size_t length) {
    std::string all;
    for (std::size_t page = at / 1024; all.size() < at % 1024 + 16 + length; ++page)
        all += e57.substr(page * 1024, 1020);
    return all.substr(at % 1024 + 16, length);
}

// Right because offsets and lengths are read off the file's XML by hand, and the bytes taken out of it here. Its other two
// images are zeros.
TEST_F(PhotosProgram, AreThoseOfTheE57FileFromInfoToTheServer) {
    REQUIRE_TEST_DATA("e57/tiny_pc_and_images.e57");
    const std::string scan = testData("e57/tiny_pc_and_images.e57").string(), bytes = contentOf(scan);
    const std::tuple<const char*, const char*, std::size_t, std::size_t> expected[] = {
        {"visual", "image/jpeg", 116, 7722}, {"spherical", "image/png", 7884, 1073}};
    EXPECT_EQ(blob(bytes, 8980, 1073), std::string(1073, '\0'));
    std::string told;
    ASSERT_EQ(run({"scancast", "info", "--check", scan}, &told), 0) << lastError;
    EXPECT_THAT(told, HasSubstr("visual: visual jpeg, 100 x 100 pixels, 7.72 kB"));
    EXPECT_THAT(told, HasSubstr("spherical: spherical png, 100 x 100 pixels, 1.07 kB"));
    EXPECT_THAT(told, HasSubstr("2 photos left out: neither JPEG nor PNG"));
    ASSERT_EQ(run({"scancast", "ingest", scan, "-q", "-o", file("tiny.scan")}), 0) << lastError;
    ASSERT_EQ(run({"scancast", "info", "--check", "--json", file("tiny.scan")}, &told), 0) << lastError;
    EXPECT_EQ(json::parse(told)["files"][0]["photos"].size(), 2U);
    // The cloud file, and the scan itself.
    for (const std::string& served : {file("tiny.scan"), scan}) {
        const auto server = serve({served});
        const json cloud = json::parse(request(port, "/api/v1/clouds").body)["clouds"][0];
        EXPECT_EQ(cloud["photos"], 2);
        const json list = json::parse(
            request(port, "/api/v1/clouds/" + cloud["id"].get<std::string>() + "/photos").body)["photos"];
        ASSERT_EQ(list.size(), 2U);
        for (std::size_t i = 0; i < 2; ++i) {
            const auto& [name, type, at, length] = expected[i];
            EXPECT_EQ(list[i]["name"], name);
            EXPECT_EQ(list[i]["projection"], name);
            EXPECT_EQ(list[i]["bytes"], length);
            const HttpReply photo = request(port, list[i]["href"].get<std::string>());
            EXPECT_EQ(photo.status, 200) << photo.body;
            EXPECT_EQ(photo.header("content-type"), type);
            EXPECT_TRUE(photo.body == blob(bytes, at, length)) << name << " of " << served;
        }
    }
}

}  // namespace
}  // namespace scancast::test
