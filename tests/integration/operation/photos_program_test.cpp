// Photos of an E57 file on their whole way: importer, cloud in memory or on disk, HTTP.
#include <gmock/gmock.h>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/integration/program_fixture.hpp"
#include "tests/support/e57/e57_writer.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// Longer than any piece on the way.
std::string someJpeg() {
    std::string bytes = "\xff\xd8\xff";
    while (bytes.size() < 1'300'000) bytes += char((bytes.size() * bytes.size()) >> 11);
    return bytes;
}

class PhotosProgram : public ProgramTest {
  protected:
    void SetUp() override {
        ProgramTest::SetUp();
        std::stringstream out(std::ios::in | std::ios::out | std::ios::binary);
        E57Writer writer(out);
        E57Scan scan;
        scan.fields = {E57Field::real("cartesianX"), E57Field::real("cartesianY"),
                       E57Field::real("cartesianZ")};
        scan.records = 4000;
        scan.real = [](std::uint64_t record, std::size_t field) {
            return field == 0 ? double(record % 64) : field == 1 ? double(record / 64) : 0.0;
        };
        scan.xml = "<name>Nave</name>" + e57Pose(0, 1, 0, 0, 1, 2, 3);  // turned upside down
        const std::string guid = writer.add(scan);
        const auto blob = e57Blob("jpegImage", writer.addBlob(jpeg), jpeg.size());
        writer.finish(
            "<images2D>" +
            e57Photo("pinholeRepresentation", blob,
                     "<imageWidth>200</imageWidth><imageHeight>100</imageHeight><pixelWidth>0.01</pixelWidth>"
                     "<pixelHeight>0.01</pixelHeight><focalLength>0.5</focalLength>",
                     "<name>Ahead</name><associatedData3DGuid>" + guid + "</associatedData3DGuid>" +
                         e57Pose(1, 0, 0, 0, 5, 6, 7)) +
            "</images2D>");
        folder.write("church.e57", out.str());
    }
    nlohmann::json list() {
        const auto reply = request(port, "/clouds/church/photos");
        EXPECT_EQ(reply.status, 200) << reply.body;
        return nlohmann::json::parse(reply.body, nullptr, false).value("photos", nlohmann::json::array());
    }
    void expectPhoto() {
        const auto photos = list();
        ASSERT_EQ(photos.size(), 1U);
        EXPECT_EQ(photos[0].value("name", ""), "Ahead");
        const auto& camera = photos[0]["view"]["camera"];
        const auto vector = [&](const char* name) {
            return glm::dvec3(camera[name][0], camera[name][1], camera[name][2]);
        };
        EXPECT_EQ(vector("eye"), glm::dvec3(5, 6, 7));
        EXPECT_LT(glm::distance(glm::normalize(vector("target") - vector("eye")), glm::dvec3(0, 0, -1)),
                  1e-9);
        const auto reply = request(port, "/clouds/church/photos/0");
        EXPECT_EQ(reply.status, 200);
        EXPECT_EQ(reply.header("content-type"), "image/jpeg");
        EXPECT_TRUE(reply.body == jpeg);
        const auto stations =
            nlohmann::json::parse(request(port, "/clouds/church/stations").body)["stations"];
        EXPECT_EQ(stations[0]["photos"], nlohmann::json::array({0}));
    }
    const std::string jpeg = someJpeg();
};

TEST_F(PhotosProgram, AreTheSameFromTheScanFromAKeptCloudAndFromACloudFile) {
    {
        const auto server = serve({file("church.e57")});
        expectPhoto();
    }
    fs::create_directories(folder / "kept");
    for (int i = 0; i < 2; ++i) {  // built, then found again
        const auto server = serve({file("church.e57"), "--cache-dir", file("kept")});
        expectPhoto();
    }
    ASSERT_EQ(run({"scancast", "ingest", file("church.e57"), "-o", file("church.scan")}), 0) << lastError;
    std::string told;
    for (const char* name : {"church.e57", "church.scan"}) {
        ASSERT_EQ(run({"scancast", "info", file(name)}, &told), 0) << lastError;
        EXPECT_THAT(told, HasSubstr("Ahead")) << name;
    }
    {
        const auto server = serve({file("church.scan")});
        expectPhoto();
    }
    ASSERT_EQ(run({"scancast", "export", file("church.scan"), "-o", file("church.las")}), 0) << lastError;
    EXPECT_THAT(lastError, HasSubstr("the photos of the scan (1) are not in the file"));
    ASSERT_EQ(run({"scancast", "ingest", file("church.e57"), "-o", file("bare.scan"), "--no-photos"}), 0)
        << lastError;
    EXPECT_THAT(lastError, Not(HasSubstr("photo")));
    ASSERT_EQ(run({"scancast", "info", file("bare.scan")}, &told), 0) << lastError;
    EXPECT_THAT(told, Not(HasSubstr("Ahead")));
    EXPECT_LT(fs::file_size(file("bare.scan")) + jpeg.size(), fs::file_size(file("church.scan")) + 1000);
}

using RealPhotosProgram = ProgramTest;

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
TEST_F(RealPhotosProgram, AreThoseOfTheE57FileFromInfoToTheServer) {
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
