// The cloud that tests of the cloud file write: a real octree, with facts that use every field.
#pragma once

#include <algorithm>
#include <span>
#include <string_view>

#include "tests/support/clouds/cloud_file_bytes.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/protocol/sample_looks.hpp"

namespace scancast::test {

/// Photos' bytes in memory.
class BytesOfPhoto final : public PhotoBytes {
  public:
    explicit BytesOfPhoto(std::string_view bytes)
        : bytes_(std::as_bytes(std::span(bytes)).begin(), std::as_bytes(std::span(bytes)).end()) {}
    Expected<std::vector<std::byte>> read() const override { return bytes_; }

  private:
    std::vector<std::byte> bytes_;
};

inline Photo withBytes(Photo photo, std::string_view bytes) {
    photo.bytes = bytes.size();
    photo.data = std::make_shared<BytesOfPhoto>(bytes);
    return photo;
}

/// Small enough that tests can try something on every byte of its index.
inline std::shared_ptr<const Cloud> sampleCloud(std::uint64_t points = 3000) {
    SyntheticSource source(points, ground, {.color = true}, 0.001);
    return build(source, 128, 1);
}

/// Numbers that only read back if every digit is there; a row of columns has 17 bytes.
inline CloudFacts fullFacts(const CloudFacts& from, bool columns) {
    CloudFacts f = from;
    f.title = "Straße \"\\\n\x01 \U0001F332";
    f.attribution = "© Łódź, CC BY 4.0";
    f.recorded = "2024-02-29";
    f.format = "LAS 1.4, point format 7";
    f.origin = {389500.1, -0.0, 1e-300};
    f.bounds = {glm::dvec3(0.1 + 0.2, -1e17 / 3, 5e-324),
                glm::dvec3(1.0 / 3, 2e17 / 3, 1.7976931348623157e308)};
    f.droppedPoints = 0xffffffffffffffffull;
    f.attributes = {true, false, true, false};
    f.intensityRange = {3, 65534};
    f.constant = {Rgb8{0, 255, 7}, std::uint16_t(65535)};
    f.notes = {"town: cloud.js says 5 points", "Straße: \"\\"};
    f.classCounts[0] = (1ull << 53) + 1;
    f.classCounts[255] = 0x8000000000000001ull;
    f.crsWkt = "PROJCS[\"NAD83 / Oregon\"]";
    f.crsEpsg = 2994;
    f.surfels = f.oriented = true;
    f.mirrors = {{.center = {1.1, 2.2, 3.3},
                  .normal = glm::normalize(glm::dvec3(1, 2, 3)),
                  .up = {0, 0, 1},
                  .width = 2.7,
                  .height = 0.1,
                  .tint = {1, 2, 255}}};
    f.usual = {.position = {glm::dvec3(0.1, -1e17 / 3, 1), glm::dvec3(1.0 / 3, 1e17 / 3, 1)},
               .intensity = {7, 60000.5},
               .brightness = {0.1, 1.0 / 3, 1}};
    f.scanner = {1.0 / 7, -389500.1, 1e-300};
    f.grid = ScanGrid{{389500.1, -0.0, 1e300}, {0.01, 1.0 / 3, 5e-324}};
    f.exact = true;
    f.stations = {{.name = "Turm, Straße", .position = {1.0 / 7, -389500.1, 1e-300}, .points = 1ull << 60},
                  {.position = {4, 5, 6}, .forwards = glm::normalize(glm::dvec3(3, 2, 1))}};
    f.photos = {withBytes({.name = "Chor, Straße",
                           .format = Photo::Format::Png,
                           .projection = Photo::Projection::Spherical,
                           .width = 0xffffffffU,
                           .height = 7,
                           .pose = Photo::Pose{{1.0 / 7, -389500.1, 1e-300}, {0, 0.6, 0.8}, {1, 0, 0}},
                           .angles = {6.25, 1.0 / 3},
                           .station = 1},
                          "the first photo's bytes"),
                withBytes({}, "the second's")};
    f.look = test::plainLook();
    if (!columns) return f;
    f.companions = {{"density", ColumnType::Uint8, ValuePlane::Of::Samples},
                    {"gps_time", ColumnType::Float32, ValuePlane::Of::Samples}};
    f.columns = {{{"gps_time", ColumnType::Float64, 1, 0, "seconds of the week"}, {-1.0 / 3, 1e9 + 0.1}},
                 {{"return_number", ColumnType::Uint8, 1, 0, ""}, {1, 5}},
                 {{"height above ground", ColumnType::Int64, 0.001, -0.7, "metres"}, {-0.25, 31.1}}};
    return f;
}

inline void expectSameFacts(const CloudFacts& a, const CloudFacts& b) {
    EXPECT_EQ(a.title, b.title);
    EXPECT_EQ(a.attribution, b.attribution);
    EXPECT_EQ(a.recorded, b.recorded);
    EXPECT_EQ(a.format, b.format);
    EXPECT_EQ(std::memcmp(&a.origin, &b.origin, sizeof a.origin), 0);
    EXPECT_EQ(std::memcmp(&a.bounds, &b.bounds, sizeof a.bounds), 0);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.droppedPoints, b.droppedPoints);
    EXPECT_EQ(a.attributes, b.attributes);
    EXPECT_EQ(a.intensityRange, b.intensityRange);
    EXPECT_EQ(a.constant, b.constant);
    EXPECT_EQ(a.notes, b.notes);
    EXPECT_EQ(a.classCounts, b.classCounts);
    EXPECT_EQ(a.crsWkt, b.crsWkt);
    EXPECT_EQ(a.crsEpsg, b.crsEpsg);
    EXPECT_EQ(a.spacing, b.spacing);
    EXPECT_EQ(a.surfels, b.surfels);
    EXPECT_EQ(a.oriented, b.oriented);
    EXPECT_EQ(a.columns, b.columns);
    EXPECT_EQ(a.companions, b.companions);
    EXPECT_EQ(a.usual, b.usual);
    EXPECT_EQ(a.scanner, b.scanner);
    EXPECT_EQ(a.grid, b.grid);
    EXPECT_EQ(a.exact, b.exact);
    EXPECT_EQ(a.stations, b.stations);
    EXPECT_TRUE(std::ranges::equal(a.photos, b.photos, sameDescription));
    EXPECT_EQ(a.look, b.look);
    EXPECT_EQ(a.revision, b.revision);
    ASSERT_EQ(a.mirrors.size(), b.mirrors.size());
    for (std::size_t i = 0; i < a.mirrors.size(); ++i) {
        EXPECT_EQ(a.mirrors[i].center, b.mirrors[i].center);
        EXPECT_EQ(a.mirrors[i].normal, b.mirrors[i].normal);
        EXPECT_EQ(a.mirrors[i].up, b.mirrors[i].up);
        EXPECT_EQ(a.mirrors[i].width, b.mirrors[i].width);
        EXPECT_EQ(a.mirrors[i].height, b.mirrors[i].height);
        EXPECT_EQ(a.mirrors[i].tint, b.mirrors[i].tint);
    }
}

inline std::vector<std::byte> sampleFile(bool columns = true) {
    const TemporaryFolder folder;
    const auto cloud = sampleCloud();
    const auto path = folder.path() / "sample.scan";
    const auto written = writeCloudFile(path, cloud->octree, fullFacts(*cloud, columns));
    EXPECT_TRUE(written) << written.error().message;
    return fileBytes(path);
}

}  // namespace scancast::test
