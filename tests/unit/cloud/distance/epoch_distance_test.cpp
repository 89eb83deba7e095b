// Distances between epochs, as trying all pairs of points gives them; and that nothing else of the cloud changes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/distance/epoch_distance.hpp"
#include "renderer/cloud/distance/epoch_pair.hpp"
#include "renderer/cloud/distance/measured_copy.hpp"
#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/file/change_facts.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/forwarding_source.hpp"
#include "tests/support/clouds/photos_in_memory.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using test::ScanPoint;
using test::SyntheticSource;
using test::uniform;

constexpr std::uint64_t fewPoints = test::sized(3000, 800);

struct Scan {
    SyntheticSource::Make make = test::ground;
    std::uint64_t points = fewPoints;
    double gridStep = 0.001;
    glm::dvec3 gridOrigin{0};
    std::optional<int> epsg{};
    bool rich = false;  ///< with a column, stations, photos, and surfels
    bool exact = true;
    std::uint32_t leafPoints = 256;
};

/// What a scan may bring along beside its points.
class RichSource final : public ForwardingSource {
  public:
    RichSource(std::unique_ptr<PointSource> source, const Scan& scan)
        : ForwardingSource(std::move(source)), scan_(scan), header_(ForwardingSource::header()) {
        header_.crsEpsg = scan.epsg;
        if (scan.rich) header_.columns = {{"gps_time", ColumnType::Float64, 1, 0, "s"}};
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        auto more = ForwardingSource::read(batch);
        if (!scan_.rich || !more || !*more) return more;
        batch.rows.resize(batch.size() * sizeof(double));
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const double time = 0.5 * double(count_++);
            std::memcpy(batch.rows.data() + i * sizeof(double), &time, sizeof time);
        }
        return more;
    }
    std::vector<Station> stations() const override {
        if (!scan_.rich) return {};
        return {{.name = "Tower", .position = {5, 5, 2}, .points = 1, .forwards = glm::dvec3(0, 1, 0)}};
    }
    std::vector<Photo> photos() const override {
        if (!scan_.rich) return {};
        Photo photo = test::photoOf(Photo::Format::Png, test::photoBytes(Photo::Format::Png, 300, 2));
        photo.name = "North";
        photo.station = 0;
        return {photo};
    }

  private:
    const Scan scan_;
    ScanHeader header_;
    std::uint64_t count_ = 0;
};

class EpochDistance : public ::testing::Test {
  protected:
    fs::path file(const std::string& name) const { return folder_ / name; }

    void make(const std::string& name, const Scan& scan) const {
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::make_unique<RichSource>(
            std::make_unique<SyntheticSource>(scan.points, scan.make,
                                              Attributes{.color = true, .classification = true},
                                              scan.gridStep, scan.gridOrigin),
            scan));
        const auto done =
            ingest(std::move(sources),
                   {.output = file(name),
                    .shape = {.leafPoints = scan.leafPoints, .surfels = scan.rich, .exact = scan.exact}});
        ASSERT_TRUE(done) << done.error().message;
    }
    std::shared_ptr<const CloudFile> open(const std::string& name) const {
        auto opened = CloudFile::open(file(name));
        EXPECT_TRUE(opened) << opened.error().message;
        return opened.value_or(nullptr);
    }
    DistanceOptions options(DistanceOptions more = {}) const {
        more.after = file("after.scan");
        more.before = file("before.scan");
        more.output = file("out.scan");
        return more;
    }
    DistanceReport measured(const DistanceOptions& more = {}) const {
        auto report = measureDistance(options(more));
        EXPECT_TRUE(report) << report.error().message;
        return report.value_or(DistanceReport{});
    }
    Error refused(const DistanceOptions& asked) const {
        const auto before = folder_.entries();
        const auto report = measureDistance(asked);
        EXPECT_FALSE(report);
        EXPECT_EQ(folder_.entries(), before) << "nothing is left behind";
        return report ? Error{} : report.error();
    }

    static std::vector<glm::dvec3> placesOf(const std::shared_ptr<const CloudFile>& cloud) {
        const auto source = cloudPoints(cloud);
        const auto all = test::readAll(*source);
        EXPECT_TRUE(all) << all.error().message;
        return {all->position.begin(), all->position.end()};
    }
    static std::vector<float> valuesOf(const CloudFile& cloud, std::uint32_t node, std::size_t plane) {
        const auto bytes = cloud.plane(node, plane);
        EXPECT_TRUE(bytes) << bytes.error().message;
        std::vector<float> values(bytes->size() / sizeof(float));
        std::memcpy(values.data(), bytes->data(), values.size() * sizeof(float));
        return values;
    }
    static std::size_t planeOf(const CloudFile& cloud, const std::string& name) {
        for (std::size_t p = 0; p < cloud.planes().size(); ++p)
            if (cloud.planes()[p].name == name) return p;
        ADD_FAILURE() << "no plane " << name;
        return 0;
    }

    /// Every point against every point.
    void expectRight(double most = 5, const glm::dvec3& shift = glm::dvec3(0)) const {
        const auto out = open("out.scan"), before = open("before.scan");
        ASSERT_TRUE(out && before);
        auto earlier = placesOf(before);
        for (glm::dvec3& p : earlier) p += shift;
        const ExactPlaces exact(out->facts(), out.get());
        const std::size_t column = planeOf(*out, "distance");
        std::uint64_t points = 0, beyond = 0;
        std::array<double, 2> range{1e300, -1e300};
        for (std::uint32_t i = 0; i < out->nodes().size(); ++i) {
            const Node& node = out->nodes()[i].node;
            const auto values = valuesOf(*out, i, column);
            if (!node.isLeaf()) {
                EXPECT_TRUE(values.empty());
                continue;
            }
            const auto samples = out->samples(i);
            ASSERT_TRUE(samples);
            ASSERT_EQ(values.size(), samples->size());
            std::vector<glm::dvec3> places(samples->size());
            ASSERT_TRUE(exact.of(i, node, *samples, places));
            for (std::size_t k = 0; k < places.size(); ++k) {
                double squared = most * most;
                for (const glm::dvec3& q : earlier) squared = std::min(squared, squaredLength(q - places[k]));
                const auto distance = float(squared < most * most ? std::sqrt(squared) : most);
                ASSERT_EQ(values[k], distance) << "leaf " << i << ", point " << k;
                range = {std::min(range[0], double(distance)), std::max(range[1], double(distance))};
                beyond += distance >= float(most);
            }
            points += places.size();
        }
        EXPECT_EQ(points, out->facts().points);
        const KeptColumn& kept = out->facts().columns.back();
        EXPECT_EQ(kept.column.name, "distance");
        EXPECT_EQ(kept.column.type, ColumnType::Float32);
        EXPECT_EQ(kept.range, range);
        ASSERT_TRUE(kept.usual);
        EXPECT_LE((*kept.usual)[0], (*kept.usual)[1]);
        ASSERT_TRUE(kept.histogram);
        std::uint64_t counted = 0;
        for (const std::uint64_t count : kept.histogram->counts) counted += count;
        EXPECT_GT(counted, points * 9 / 10);
        EXPECT_LE(counted, points);
        lastBeyond_ = beyond;
    }

    test::TemporaryFolder folder_;
    mutable std::uint64_t lastBeyond_ = 0;  ///< as expectRight() counted
};

ScanPoint otherGround(std::uint64_t i, std::uint64_t n) {
    ScanPoint p = test::ground(i, n);
    p.position += glm::dvec3(0.3 * uniform(i, 31), 0.3 * uniform(i, 32), 0.05 * uniform(i, 33));
    // A heap that was not there.
    const double from = std::hypot(p.position.x - 60, p.position.y - 80);
    if (from < 15) p.position.z += 0.3 * (15 - from);
    return p;
}

TEST_F(EpochDistance, IsThatToTheNearestPointOfAll) {
    make("before.scan", {});
    make("after.scan", {.make = otherGround});
    const auto report = measured();
    EXPECT_EQ(report.points, fewPoints);
    expectRight();
}

TEST_F(EpochDistance, OriginsAndGridsMayDiffer) {
    const glm::dvec3 utm(389'400, 5'819'700, 40);
    const auto there = [&](SyntheticSource::Make make, const glm::dvec3& to) {
        return [make = std::move(make), to](std::uint64_t i, std::uint64_t n) {
            ScanPoint p = make(i, n);
            p.position += to;
            return p;
        };
    };
    make("before.scan",
         {.make = there(test::ground, utm), .gridStep = 0.01, .gridOrigin = {380'000, 5'800'000, 0}});
    make("after.scan", {.make = there(otherGround, utm + glm::dvec3(20, -35, 0.1)),
                        .gridStep = 0.00025,
                        .gridOrigin = {389'000.5, 5'819'000.125, -3}});
    measured();
    expectRight();
}

TEST_F(EpochDistance, PositionsWithoutAGridAreTakenAsTheyAreKept) {
    for (const bool exact : {true, false}) {
        make("before.scan", {.gridStep = 0, .exact = exact});
        make("after.scan", {.make = otherGround, .gridStep = 0, .exact = exact});
        measured();
        expectRight();
        fs::remove(file("out.scan"));
    }
}

TEST_F(EpochDistance, TheEarlierEpochMayBeShifted) {
    make("before.scan", {});
    make("after.scan", {.make = otherGround});
    const glm::dvec3 shift(12.5, -3.25, 1.0 / 3);
    measured({.shift = shift});
    expectRight(5, shift);
}

TEST_F(EpochDistance, WhatIsFartherThanTheLimitHasTheLimit) {
    make("before.scan", {.make = [](std::uint64_t i, std::uint64_t n) {
             ScanPoint p = test::ground(i, n);
             if (p.position.x > 100) p.position.x -= 100;  // half of the place is empty
             return p;
         }});
    make("after.scan", {.make = otherGround});
    for (const double most : {0.75, 5.0, 1000.0}) {
        const auto report = measured({.most = most});
        expectRight(most);
        EXPECT_EQ(report.beyond, lastBeyond_);
        if (most < 10) {
            EXPECT_GT(report.beyond, fewPoints / 3);
        }
        if (most > 500) {
            EXPECT_EQ(report.beyond, 0u);
        }
    }
}

TEST_F(EpochDistance, EpochsThatDoNotTouchAreFarAway) {
    make("before.scan", {});
    make("after.scan", {.make = [](std::uint64_t i, std::uint64_t n) {
             ScanPoint p = test::ground(i, n);
             p.position += glm::dvec3(5000, 0, 0);
             return p;
         }});
    const auto report = measured();
    EXPECT_EQ(report.beyond, fewPoints);
    EXPECT_EQ(report.median, 5);
    expectRight();
}

TEST_F(EpochDistance, OnePointIsAnEpoch) {
    const auto lone = [](std::uint64_t, std::uint64_t) { return ScanPoint{.position = {100, 100, 2}}; };
    make("before.scan", {.make = lone, .points = 1});
    make("after.scan", {.make = otherGround});
    measured({.most = 60});
    expectRight(60);
    make("before.scan", {});
    make("after.scan", {.make = lone, .points = 1});
    measured();
    expectRight();
}

TEST_F(EpochDistance, AnEpochMeasuredToItsCopyHasNoDistances) {
    make("after.scan", {.make = otherGround, .leafPoints = 100});
    make("before.scan", {.make = otherGround, .leafPoints = 1000});
    const auto report = measured();
    EXPECT_EQ(report.column.range, (std::array<double, 2>{0, 0}));
    expectRight();
}

TEST_F(EpochDistance, TheFileIsTheSameForAnyNumberOfThreadsAndAnyRoom) {
    make("before.scan", {.leafPoints = 64});
    make("after.scan", {.make = otherGround, .rich = true, .leafPoints = 64});
    measured({.threads = 1, .memoryLimit = leastDistanceMemory});
    const std::string whole = test::contentOf(file("out.scan"));
    measured({.threads = 7});
    EXPECT_TRUE(test::contentOf(file("out.scan")) == whole);
    // As if the cloud were larger than memory: subtree by subtree, and no tree is kept.
    const auto after = open("after.scan"), before = open("before.scan");
    for (const std::uint64_t chunk : {std::uint64_t(1), fewPoints / 5}) {
        auto writer = CloudFileWriter::create(file("small.scan"));
        ASSERT_TRUE(writer);
        const EarlierPoints earlier(before, glm::dvec3(0), 0);
        const Column column = distanceColumn({}, before->facts(), "");
        MeasuredCopy copy(*after, earlier, {.column = column, .most = 5, .chunkPoints = chunk}, **writer);
        const auto facts = copy.write({}, {});
        ASSERT_TRUE(facts) << facts.error().message;
        EXPECT_TRUE(test::contentOf(file("small.scan")) == whole) << chunk;
    }
}

/// The facts but for what a column changes.
nlohmann::json otherFacts(const CloudFile& cloud) {
    const auto text = printFacts(cloud.facts(), cloud.writtenBy(), cloud.photoPlaces());
    EXPECT_TRUE(text) << text.error().message;
    auto json = nlohmann::json::parse(text.value_or("{}"));
    for (const char* changed : {"columns", "planes", "revision"}) json.erase(changed);
    for (auto& photo : json["photos"]) photo.erase("offset");
    return json;
}

TEST_F(EpochDistance, EverythingElseOfTheCloudStays) {
    make("before.scan", {});
    make("after.scan", {.make = otherGround, .rich = true});
    ASSERT_TRUE(changeFacts(file("after.scan"), [](CloudFacts& facts) -> Expected<void> {
        facts.title = "Hill";
        facts.attribution = "City of Graz, CC BY 4.0";
        facts.recorded = "2024-05";
        facts.mirrors.push_back(
            {.center = {1, 2, 3}, .normal = {0, 0, 1}, .up = {0, 1, 0}, .width = 2, .height = 3});
        facts.notes.push_back("it is made up");
        return {};
    }));
    measured();
    const auto after = open("after.scan"), out = open("out.scan");
    EXPECT_EQ(otherFacts(*after), otherFacts(*out));
    EXPECT_NE(after->facts().revision, out->facts().revision);
    ASSERT_EQ(out->nodes().size(), after->nodes().size());
    ASSERT_EQ(after->facts().columns.size() + 1, out->facts().columns.size());
    ASSERT_GT(after->planes().size(), 1u);
    ASSERT_EQ(out->planes().size(), after->planes().size() + 2);
    for (std::uint32_t i = 0; i < out->nodes().size(); ++i) {
        const auto samples = out->samples(i), were = after->samples(i);
        ASSERT_TRUE(samples && were);
        ASSERT_EQ(samples->size(), were->size());
        EXPECT_EQ(std::memcmp(samples->data(), were->data(), were->size() * sizeof(Sample)), 0);
        EXPECT_EQ(std::memcmp(&out->nodes()[i].node, &after->nodes()[i].node, sizeof(Node)), 0);
        for (std::size_t p = 0; p < after->planes().size(); ++p) {
            const std::size_t now = planeOf(*out, after->planes()[p].name);
            EXPECT_EQ(out->planes()[now], after->planes()[p]);
            EXPECT_EQ(*out->plane(i, now), *after->plane(i, p));
        }
    }
    ASSERT_EQ(out->facts().photos.size(), 1u);
    EXPECT_EQ(*out->facts().photos[0].data->read(), *after->facts().photos[0].data->read());
    EXPECT_TRUE(
        out->facts().columns.back().column.description.starts_with("distance to the nearest point of before"))
        << out->facts().columns.back().column.description;
    // And once more, to another epoch: under another name.
    make("earlier.scan", {.points = 500});
    auto again = options({.name = "since_2019"});
    again.after = file("out.scan");
    again.before = file("earlier.scan");
    again.output = file("twice.scan");
    const auto twice = measureDistance(again);
    ASSERT_TRUE(twice) << twice.error().message;
    const auto both = open("twice.scan");
    ASSERT_EQ(both->facts().columns.size(), out->facts().columns.size() + 1);
    for (std::uint32_t i = 0; i < out->nodes().size(); ++i)
        for (const char* kept : {"distance", "inner:distance"})
            EXPECT_EQ(*both->plane(i, planeOf(*both, kept)), *out->plane(i, planeOf(*out, kept)));
}

std::vector<double> doublesOf(const CloudFile& cloud, std::uint32_t node, std::size_t plane) {
    const auto bytes = cloud.plane(node, plane);
    EXPECT_TRUE(bytes) << bytes.error().message;
    std::vector<double> values(bytes->size() / sizeof(double));
    std::memcpy(values.data(), bytes->data(), values.size() * sizeof(double));
    return values;
}

TEST_F(EpochDistance, InnerNodesHaveTheValuesOfThePointsThatOtherColumnsHaveThere) {
    make("before.scan", {});
    make("after.scan", {.make = otherGround, .points = 2 * fewPoints, .rich = true, .leafPoints = 128});
    measured();
    const auto out = open("out.scan");
    const std::size_t distance = planeOf(*out, "distance"), time = planeOf(*out, "gps_time");
    const std::size_t innerDistance = planeOf(*out, "inner:distance"),
                      innerTime = planeOf(*out, "inner:gps_time");
    std::map<double, float> distances;  // each point has a time of its own
    for (std::uint32_t i = 0; i < out->nodes().size(); ++i) {
        const auto times = doublesOf(*out, i, time);
        const auto values = valuesOf(*out, i, distance);
        for (std::size_t k = 0; k < times.size(); ++k) distances[times[k]] = values[k];
    }
    ASSERT_EQ(distances.size(), 2 * fewPoints);
    std::uint64_t inner = 0;
    for (std::uint32_t i = 0; i < out->nodes().size(); ++i) {
        const auto times = doublesOf(*out, i, innerTime);
        const auto values = valuesOf(*out, i, innerDistance);
        ASSERT_EQ(times.size(), values.size());
        ASSERT_EQ(values.size(), out->nodes()[i].node.isLeaf() ? 0 : out->nodes()[i].node.sampleCount);
        for (std::size_t k = 0; k < times.size(); ++k) ASSERT_EQ(values[k], distances.at(times[k]));
        inner += times.size();
    }
    EXPECT_GT(inner, 100u);
}

TEST_F(EpochDistance, WhatCannotBeMeantIsRefused) {
    make("before.scan", {.points = 100, .epsg = 25833});
    make("after.scan", {.points = 100, .epsg = 25832, .rich = true});
    EXPECT_EQ(refused(options()).field, "before");
    EXPECT_NE(refused(options()).message.find("EPSG:25832"), std::string::npos) << refused(options()).message;
    make("before.scan", {.points = 100});
    for (const double most : {0.0, -1.0, std::nan(""), 1e300})
        EXPECT_EQ(refused(options({.most = most})).field, "max");
    EXPECT_EQ(refused(options({.shift = {0, INFINITY, 0}})).field, "shift");
    for (const char* name : {"", "a b", "inner:x", "gps_time", "intensity", "red_16", "größe",
                             "a_name_that_is_longer_than_las_has_room_for"})
        EXPECT_EQ(refused(options({.name = name})).field, "name") << name;
    EXPECT_EQ(refused(options({.memoryLimit = 1000})).field, "memory-limit");
    auto asked = options();
    asked.before = file("nothing.scan");
    EXPECT_EQ(refused(asked).code, ErrorCode::NotFound);
    asked.before = folder_.write("scan.las", "LASF but not a cloud file");
    EXPECT_EQ(refused(asked).code, ErrorCode::Unsupported);
    EXPECT_NE(refused(asked).message.find("scancast ingest"), std::string::npos);
    asked.before = asked.after;
    EXPECT_EQ(refused(asked).field, "before");
    asked = options();
    asked.output = asked.before;
    EXPECT_EQ(refused(asked).field, "output");
    make("before.scan", {.points = 100, .epsg = 4326});
    EXPECT_EQ(refused(options()).code, ErrorCode::Unsupported) << refused(options()).message;
    // Of two local systems nobody knows whether they are one; their units are known to differ.
    const auto local = [](const char* unit) {
        return [unit](CloudFacts& facts) -> Expected<void> {
            facts.crsWkt = std::string("LOCAL_CS[\"site\",UNIT[") + unit + "]]";
            facts.crsEpsg = {};
            return {};
        };
    };
    make("before.scan", {.points = 100});
    make("after.scan", {.points = 100});
    ASSERT_TRUE(changeFacts(file("before.scan"), local("\"metre\",1")));
    ASSERT_TRUE(changeFacts(file("after.scan"), local("\"US survey foot\",0.30480060960121924")));
    EXPECT_NE(refused(options()).message.find("foot"), std::string::npos) << refused(options()).message;
    // More than a cloud file has room for is refused before any work.
    CloudFacts full = open("after.scan")->facts();
    while (full.companions.size() < 64)
        full.companions.push_back(
            {fmt::format("value_{}", full.companions.size()), ColumnType::Uint8, ValuePlane::Of::Samples});
    EXPECT_FALSE(checkColumnName("distance", full));
    full.companions.pop_back();
    EXPECT_TRUE(checkColumnName("distance", full));
    make("after.scan", {.points = 100, .epsg = 25832});
    make("before.scan", {.points = 100});
    // One side that says nothing is taken for the other, and that is told.
    make("before.scan", {.points = 100});
    EXPECT_EQ(measured().remarks.size(), 1u);
}

TEST_F(EpochDistance, WhatIsDamagedLeavesNothing) {
    make("before.scan", {});
    make("after.scan", {.make = otherGround});
    std::string bytes = test::contentOf(file("before.scan"));
    for (std::size_t i = 200; i < 20'000; ++i) bytes[i] = char(bytes[i] ^ 0x55);
    folder_.write("before.scan", bytes);
    EXPECT_EQ(refused(options()).code, ErrorCode::Malformed);
}

TEST_F(EpochDistance, StoppedItLeavesNothing) {
    make("before.scan", {});
    make("after.scan", {.make = otherGround});
    std::stop_source stop;
    stop.request_stop();
    const auto entries = folder_.entries();
    const auto report = measureDistance(options(), {}, stop.get_token());
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::Cancelled);
    EXPECT_EQ(folder_.entries(), entries);
}

}  // namespace
}  // namespace scancast
