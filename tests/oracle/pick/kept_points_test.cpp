// Picks of real scans in UTM against an independent read of their files: raw records, of which scale and offset make coordinates, as any reader
// of LAS does it. Right because nothing of import, octree or cloud file has a part in that; nor, of one of them, of our decoder of LAZ: what
// is picked in the LAZ file is held against the LAS file of the same points.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <span>

#include "files/bytes.hpp"
#include "importers/laz/decoder/laz_file.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/pick/pick.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "renderer/select/viewpoint.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_data.hpp"

namespace scancast::test {
namespace {

using Coordinates = std::array<double, 3>;
struct RawRecord {
    std::uint16_t intensity = 0;
    std::uint8_t returns = 0;
    double time = 0;
};

using Records = std::multimap<Coordinates, RawRecord>;

/// Records as they lie in LAS, by their coordinates; `head`: the file's first bytes.
void addRecords(const std::byte* head, std::span<const std::byte> records, Records& all) {
    const std::size_t stride = loadLe<std::uint16_t>(head + 105);
    const unsigned format = loadLe<std::uint8_t>(head + 104) & 0x3f;
    for (std::size_t at = 0; at + stride <= records.size(); at += stride) {
        const std::byte* record = records.data() + at;
        Coordinates place{};
        for (std::size_t a = 0; a < 3; ++a)
            place[a] = loadLe<double>(head + 155 + 8 * a) +
                       loadLe<double>(head + 131 + 8 * a) * loadLe<std::int32_t>(record + 4 * a);
        const auto returns = loadLe<std::uint8_t>(record + 14);
        const bool hasTime = format != 0 && format != 2;
        all.emplace(place, RawRecord{loadLe<std::uint16_t>(record + 12),
                                     std::uint8_t(returns & (format < 6 ? 7 : 15)),
                                     hasTime ? loadLe<double>(record + (format < 6 ? 20 : 22)) : 0});
    }
}

Records recordsOfLas(const std::filesystem::path& path) {
    Records all;
    std::ifstream in(path, std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(in), {});
    const auto whole = std::as_bytes(std::span(bytes));
    EXPECT_GT(whole.size(), 227U);
    if (whole.size() > 227)
        addRecords(whole.data(), whole.subspan(loadLe<std::uint32_t>(whole.data() + 96)), all);
    return all;
}

Records recordsOfLaz(const std::filesystem::path& path) {
    Records all;
    auto input = InputFile::open(path);
    EXPECT_TRUE(input);
    const auto laz = laz::LazFile::open(std::make_shared<laz::FileAccess>(std::move(*input)));
    EXPECT_TRUE(laz) << laz.error().message;
    if (!laz) return all;
    for (const laz::Chunk& chunk : laz->chunks()) {
        std::vector<std::byte> records(std::size_t(chunk.points) *
                                       loadLe<std::uint16_t>(laz->head().data() + 105));
        EXPECT_TRUE(laz::decodeChunk(*laz, chunk, records));
        addRecords(laz->head().data(), records, all);
    }
    return all;
}

double valueOf(const KeptPoint& point, std::string_view name) {
    std::size_t at = 0;
    for (const Column& column : point.columns) {
        if (column.name == name)
            return column.type == ColumnType::Float64 ? loadLe<double>(point.row.data() + at)
                                                      : double(loadLe<std::uint8_t>(point.row.data() + at));
        at += bytesOf(column.type);
    }
    return std::nan("");
}

struct UtmScan {
    const char* scan;
    const char* points;  ///< the file whose records they are
};
class RealUtmScans : public ::testing::TestWithParam<UtmScan> {};

TEST_P(RealUtmScans, PickedCoordinatesAreThoseOfAPointOfTheFile) {
    REQUIRE_TEST_DATA(GetParam().scan);
    REQUIRE_TEST_DATA(GetParam().points);
    const std::filesystem::path file = testData(GetParam().points);
    const Records records = file.extension() == ".las" ? recordsOfLas(file) : recordsOfLaz(file);
    ASSERT_GT(records.size(), 1000U);
    const TemporaryFolder folder;
    std::vector<std::unique_ptr<PointSource>> sources;
    sources.push_back(openScan(testData(GetParam().scan),
                               {.importerDirectory = SCANCAST_BIN_DIR, .keepAttributes = true, .exact = true})
                          .value());
    const std::filesystem::path path = folder / "scan.scan";
    ASSERT_TRUE(
        ingest(std::move(sources),
               {.output = path, .shape = {.leafPoints = 2000, .chunkPoints = 50'000, .exact = true}}));
    BlockCacheOptions options;
    options.memoryLimit = 256 << 20;
    const auto cloud = openCloud(path, BlockCache::create(options)).value();
    const View view = defaultView(*cloud, 640, 480);
    const auto viewpoint = Viewpoint::create(view, cloud->origin, cloud->bounds).value();
    int picks = 0, index = 0;
    for (const auto& [place, record] : records) {
        if (index++ % std::max<int>(1, int(records.size()) / 150) != 0) continue;
        const glm::dvec3 relative = glm::dvec3(place[0], place[1], place[2]) - cloud->origin;
        const glm::dvec3 seen =
            viewpoint.project(glm::dvec3(viewpoint.cloudToView * glm::dvec4(relative, 1)));
        if (!(seen.x >= 0 && seen.x < 640 && seen.y >= 0 && seen.y < 480)) continue;
        const auto picked = pick(*cloud, view, {int(seen.x), int(seen.y)}, seen.z);
        ASSERT_TRUE(picked && *picked) << (picked ? "nothing" : picked.error().message);
        const KeptPoint& point = (*picked)->point;
        EXPECT_TRUE(point.exact);
        const auto [from, to] = records.equal_range({point.position.x, point.position.y, point.position.z});
        ASSERT_NE(from, to) << "no point of the file is at " << point.position.x << " " << point.position.y;
        // And its attributes are those of a record there.
        const bool isRecord = std::any_of(from, to, [&](const auto& one) {
            const double time = valueOf(point, "gps_time");
            return one.second.intensity == (*picked)->sample.intensity &&
                   double(one.second.returns) == valueOf(point, "return_number") &&
                   (std::isnan(time) || time == one.second.time);
        });
        EXPECT_TRUE(isRecord);
        ++picks;
    }
    EXPECT_GT(picks, 50);
}

INSTANTIATE_TEST_SUITE_P(Four, RealUtmScans,
                         ::testing::Values(UtmScan{"laz/pdrf2-color.laz", "las/las12-pdrf2-color.las"},
                                           UtmScan{"laz/Megaplot.laz", "laz/Megaplot.laz"},
                                           UtmScan{"laz/MixedConifer.laz", "laz/MixedConifer.laz"},
                                           UtmScan{"laz/fullwave-pdrf10.laz", "laz/fullwave-pdrf10.laz"}));

}  // namespace
}  // namespace scancast::test
