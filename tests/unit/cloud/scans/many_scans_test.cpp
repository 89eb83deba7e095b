// Several scans as one cloud.
#include <gtest/gtest.h>

#include "renderer/cloud/build/lazy_scan.hpp"
#include "renderer/cloud/build/many_scans.hpp"
#include "renderer/cloud/forwarding_source.hpp"
#include "tests/support/clouds/octree_checks.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast {
namespace {

using test::ScanPoint;
using test::SyntheticSource;

/// A strip of a plane, `count` points from x = first on.
SyntheticSource::Make strip(double first) {
    return [first](std::uint64_t i, std::uint64_t) {
        return ScanPoint{
            .position = {first + double(i % 100), double(i / 100), 0}, .color = {9, 9, 9}, .intensity = 77};
    };
}

/// A source whose header a test may change.
class Described final : public ForwardingSource {
  public:
    Described(std::unique_ptr<PointSource> source, std::function<void(ScanHeader&)> change)
        : ForwardingSource(std::move(source)), header_(this->source().header()) {
        change(header_);
    }
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        auto more = source().read(batch);
        const std::size_t stride = rowBytes(header_.columns);
        for (std::size_t i = 0; i < batch.size() * stride; ++i)
            batch.rows.push_back(std::byte(i % stride + 1));
        return more;
    }
    std::uint64_t droppedPoints() const override { return 3; }
    std::vector<std::string> notes() const override { return {"strange"}; }

  private:
    ScanHeader header_;
};

std::unique_ptr<PointSource> scan(double first, Attributes attributes,
                                  std::function<void(ScanHeader&)> change = {}) {
    auto source = std::make_unique<SyntheticSource>(1000, strip(first), attributes, 0.001);
    return std::make_unique<Described>(
        std::move(source), change ? std::move(change) : [](ScanHeader&) {});
}

template <class... Scans>
Expected<std::unique_ptr<PointSource>> together(Scans... scans) {
    std::vector<std::unique_ptr<PointSource>> list;
    (list.push_back(std::move(scans)), ...);
    return manyScans(std::move(list));
}

TEST(ManyScans, AreOneCloud) {
    auto all = together(scan(0, {.color = true}), scan(100, {.intensity = true}), scan(200, {}));
    ASSERT_TRUE(all);
    EXPECT_EQ((*all)->header().points, 3000u);
    EXPECT_EQ((*all)->header().attributes, (Attributes{.color = true, .intensity = true}));
    EXPECT_EQ((*all)->header().format, "3 scans: synthetic");
    const auto cloud = test::build(**all);
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->points, 3000u);
    EXPECT_EQ(cloud->droppedPoints, 9u);
    EXPECT_EQ(cloud->notes, (std::vector<std::string>(3, "strange")));
    EXPECT_EQ(cloud->bounds[1].x, 299);
    test::checkStructure(*cloud, 512);
}

TEST(ManyScans, OfThoseWithoutNearInfraredItIsZero) {
    const auto withInfrared = [](std::uint64_t i, std::uint64_t) {
        return ScanPoint{.position = {double(i), 0, 0}, .nearInfrared = std::uint16_t(100 + i % 100)};
    };
    auto all = together(
        scan(2000, {}),
        std::make_unique<SyntheticSource>(1000, withInfrared, Attributes{.nearInfrared = true}, 0.001),
        scan(4000, {}));
    ASSERT_TRUE(all);
    EXPECT_TRUE((*all)->header().attributes.nearInfrared);
    const auto cloud = test::build(**all);
    ASSERT_TRUE(cloud);
    EXPECT_TRUE(hasNearInfrared(*cloud));
    for (std::uint32_t i = 0; i < cloud->octree.nodes().size(); ++i) {
        const Node& node = cloud->octree.node(i);
        if (!node.isLeaf()) continue;
        const auto run = cloud->octree.run(i).value();
        for (std::size_t s = 0; s < run.samples.size(); ++s) {
            const double x = std::round(position(node, run.samples[s]).x + cloud->origin.x);
            EXPECT_EQ(nearInfraredIn(run.beside[s]), x < 1000 ? 100 + int(x) % 100 : 0) << x;
        }
    }
}

TEST(ManyScans, NearInfraredThatIsTheSameInOneAndMissingInAnotherVaries) {
    const auto same = [](std::uint16_t value) {
        return std::make_unique<SyntheticSource>(
            1000,
            [value](std::uint64_t i, std::uint64_t) {
                return ScanPoint{.position = {double(i), 0, 0}, .nearInfrared = value};
            },
            Attributes{.nearInfrared = true}, 0.001);
    };
    auto beside = together(same(200), scan(2000, {}));
    const auto cloud = test::build(**beside);
    EXPECT_TRUE(hasNearInfrared(*cloud));
    EXPECT_EQ(cloud->notes, (std::vector<std::string>{"strange"}));
    auto alone = together(same(200));
    EXPECT_FALSE(hasNearInfrared(*test::build(**alone)));
    auto mixed = together(same(200), same(40'000));
    EXPECT_EQ(
        test::build(**mixed)->notes,
        (std::vector<std::string>{"near infrared has 8 bits in 1 of the scans and 16 in others: that of 8 is "
                                  "black beside these"}));
}

TEST(ManyScans, EachStoodWhereItStood) {
    const auto stoodAt = [](double x) {
        return [x](ScanHeader& h) { h.scannerOrigin = glm::dvec3(x, 2, 3); };
    };
    auto all = together(scan(0, {}, stoodAt(1)), scan(500, {}), scan(900, {}, stoodAt(7)));
    ASSERT_TRUE(all);
    EXPECT_EQ((*all)->header().scannerOrigin, std::nullopt) << "no one place explains all points";
    PointBatch batch;
    std::vector<std::optional<glm::dvec3>> scanners;
    while ((*all)->read(batch).value()) scanners.push_back(batch.scanner);
    EXPECT_EQ(scanners, (std::vector<std::optional<glm::dvec3>>{glm::dvec3(1, 2, 3), std::nullopt,
                                                                glm::dvec3(7, 2, 3)}));
}

TEST(ManyScans, GridsThatDifferAreNoGrid) {
    auto all = together(scan(0, {}), scan(100, {}, [](ScanHeader& h) { h.gridStep = glm::dvec3(0.01); }));
    ASSERT_TRUE(all);
    EXPECT_EQ((*all)->header().gridStep, glm::dvec3(0));
    EXPECT_TRUE(test::build(**all));
}

TEST(ManyScans, ContradictingCoordinateSystemsAreRefused) {
    const auto all = together(scan(0, {}, [](ScanHeader& h) { h.crsEpsg = 25832; }), scan(0, {}),
                              scan(0, {}, [](ScanHeader& h) { h.crsEpsg = 25833; }));
    ASSERT_FALSE(all);
    EXPECT_EQ(all.error().code, ErrorCode::InvalidArgument);
    EXPECT_NE(all.error().message.find("EPSG:25832"), std::string::npos) << all.error().message;
    EXPECT_NE(all.error().message.find("EPSG:25833"), std::string::npos) << all.error().message;
}

// Where a scan lies that has no bounds in its header is known once it is read: before anything is built of it.
TEST(ManyScans, WhatLiesFarAwayIsFoundWhileItIsRead) {
    const auto withCrs = [](ScanHeader& h) { h.crsEpsg = 25832, h.bounds.reset(); };
    const auto without = [](ScanHeader& h) { h.bounds.reset(); };
    auto far = together(scan(500'000, {}, withCrs), scan(1'200'000, {}, without));
    ASSERT_TRUE(far) << "nobody knows yet";
    PointBatch batch;
    auto refused = (*far)->read(batch);
    while (refused && *refused) refused = (*far)->read(batch);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
    EXPECT_NE(refused.error().message.find("scan 2 does not say"), std::string::npos)
        << refused.error().message;
    EXPECT_NE(refused.error().message.find("700 km"), std::string::npos) << refused.error().message;

    auto near = together(scan(500'000, {}, withCrs), scan(500'200, {}, without));
    ASSERT_TRUE(near);
    const auto cloud = test::build(**near);
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->crsEpsg, 25832);
    ASSERT_EQ(cloud->notes.size(), 3u);
    EXPECT_NE(cloud->notes[0].find("that of scan 1, ETRS89 / UTM zone 32N (EPSG:25832), is taken for it"),
              std::string::npos)
        << cloud->notes[0];
}

TEST(ManyScans, RowsAreThoseOfTheFirst) {
    const Column time{.name = "time", .type = ColumnType::Uint16, .scale = 1, .offset = 0, .description = ""};
    const Column angle{
        .name = "angle", .type = ColumnType::Uint8, .scale = 1, .offset = 0, .description = ""};
    auto all = together(scan(0, {},
                             [&](ScanHeader& h) {
                                 h.columns = {time, angle};
                             }),
                        scan(0, {}, [&](ScanHeader& h) { h.columns = {angle}; }), scan(0, {}));
    ASSERT_TRUE(all);
    PointBatch batch;
    std::vector<std::array<int, 3>> firstRows;
    while (*(*all)->read(batch)) {
        ASSERT_EQ(batch.rows.size(), batch.size() * 3);
        firstRows.push_back({int(batch.rows[0]), int(batch.rows[1]), int(batch.rows[2])});
    }
    EXPECT_EQ(firstRows, (std::vector<std::array<int, 3>>{{1, 2, 3}, {0, 0, 1}, {0, 0, 0}}));
}

TEST(LazyScan, IsOpenOnlyWhileItIsRead) {
    int open = 0, opened = 0;
    struct Counted final : SyntheticSource {
        Counted(int& now) : SyntheticSource(1000, strip(0), {}, 0.001), now_(now) { ++now_; }
        ~Counted() override { --now_; }
        int& now_;
    };
    auto lazy = lazyScan([&]() -> Expected<std::unique_ptr<PointSource>> {
        ++opened;
        return std::make_unique<Counted>(open);
    });
    ASSERT_TRUE(lazy);
    EXPECT_EQ(open, 0);
    EXPECT_EQ((*lazy)->header().points, 1000u);
    PointBatch batch;
    ASSERT_TRUE(*(*lazy)->read(batch));
    EXPECT_EQ(open, 1);
    ASSERT_FALSE(*(*lazy)->read(batch));
    EXPECT_EQ(open, 0);
    EXPECT_FALSE(*(*lazy)->read(batch));
    EXPECT_EQ(opened, 2);
}

TEST(LazyScan, WhatCannotBeOpenedIsAnErrorAtOnce) {
    const auto lazy = lazyScan(
        []() -> Expected<std::unique_ptr<PointSource>> { return fail(ErrorCode::NotFound, "gone"); });
    ASSERT_FALSE(lazy);
    EXPECT_EQ(lazy.error().message, "gone");
}

}  // namespace
}  // namespace scancast
