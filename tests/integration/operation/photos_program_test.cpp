// Photos of an E57 file on their whole way: importer, cloud in memory or on disk, HTTP.
#include <gmock/gmock.h>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/integration/program_fixture.hpp"
#include "tests/support/e57/e57_writer.hpp"

namespace scancast::test {
namespace {

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

}  // namespace
}  // namespace scancast::test
