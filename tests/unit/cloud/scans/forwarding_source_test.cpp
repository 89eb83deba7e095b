// Each question is answered by the source that is wrapped: what a wrapper forgets is lost without a word.
#include "renderer/cloud/forwarding_source.hpp"

#include <gmock/gmock.h>

#include "renderer/cloud/exact_scan.hpp"
#include "renderer/cloud/export/region.hpp"
#include "renderer/cloud/import/assumed_crs.hpp"

namespace scancast {
namespace {

using testing::ElementsAre;

/// An answer of its own to everything.
class Telling final : public PointSource {
  public:
    Telling() {
        header_.format = "telling";
        header_.gridStep = glm::dvec3(1);
    }
    const ScanHeader& header() const override { return header_; }
    Expected<PointBatch> glance() override {
        PointBatch points;
        points.position = std::vector{glm::dvec3(1), glm::dvec3(9)};
        return points;
    }
    bool hasParts() const override { return true; }
    void readPart(std::uint64_t first, std::uint64_t count) override { part = {first, count}; }
    bool wantsToBeSeen() const override { return true; }
    Expected<std::uint16_t> lookAt(std::uint64_t first, std::uint64_t count) override {
        return std::uint16_t(first + count);
    }
    void hasSeen(std::uint16_t highest) override { seen = highest; }
    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        if (reads_++ > 0) return false;
        batch.position = std::vector{glm::dvec3(2)};
        return true;
    }
    std::uint64_t droppedPoints() const override { return 3; }
    std::vector<std::string> notes() const override { return {"a note"}; }
    std::vector<Station> stations() const override { return {{.name = "a place"}}; }
    std::vector<Photo> photos() const override { return {{.name = "a photo"}}; }
    std::array<std::uint64_t, 2> bytesRead() const override { return {4, 5}; }

    std::array<std::uint64_t, 2> part{};
    std::uint16_t seen = 0;

  private:
    ScanHeader header_;
    int reads_ = 0;
};

class Plain final : public ForwardingSource {
  public:
    explicit Plain(std::unique_ptr<PointSource> source) : ForwardingSource(std::move(source)) {}
};

void expectAllIsTold(const PointSource& source) {
    EXPECT_EQ(source.header().format, "telling");
    EXPECT_EQ(source.droppedPoints(), 3U);
    EXPECT_THAT(source.notes(), ElementsAre("a note"));
    EXPECT_THAT(source.stations(), ElementsAre(Station{.name = "a place"}));
    ASSERT_EQ(source.photos().size(), 1U);
    EXPECT_EQ(source.photos()[0].name, "a photo");
    EXPECT_EQ(source.bytesRead(), (std::array<std::uint64_t, 2>{4, 5}));
    EXPECT_TRUE(source.hasParts());
    EXPECT_TRUE(source.wantsToBeSeen());
}

TEST(ForwardingSource, AnswersAsWhatItWraps) {
    auto telling = std::make_unique<Telling>();
    const Telling& wrapped = *telling;
    Plain source(std::move(telling));
    expectAllIsTold(source);
    source.readPart(6, 7);
    EXPECT_EQ(wrapped.part, (std::array<std::uint64_t, 2>{6, 7}));
    EXPECT_EQ(source.lookAt(8, 9).value(), 17U);
    source.hasSeen(10);
    EXPECT_EQ(wrapped.seen, 10U);
    EXPECT_EQ(source.glance().value().size(), 2U);
    PointBatch batch;
    EXPECT_TRUE(source.read(batch).value());
    EXPECT_EQ(batch.position[0], glm::dvec3(2));
    EXPECT_FALSE(source.read(batch).value());
}

TEST(ForwardingSource, SoDoThoseThatChangeSomething) {
    const auto telling = [] { return std::make_unique<Telling>(); };
    const PointsRegion low{.clip = ClipBox{.min = glm::dvec3(0), .max = glm::dvec3(5)}};
    const std::unique_ptr<PointSource> sources[] = {withCrs(telling(), {"", 25832}, "a.las"),
                                                    exactScan(telling(), false), within(low, telling())};
    for (const unsigned i : {0U, 1U, 2U}) {
        SCOPED_TRACE(i);
        expectAllIsTold(*sources[i]);
        EXPECT_EQ(sources[i]->glance().value().size(), i == 2 ? 1U : 2U) << "only what is in the region";
    }
}

TEST(ClosedSource, RemembersWhatWasTold) {
    std::unique_ptr<PointSource> closed;
    {
        Telling source;
        closed = std::make_unique<ClosedSource>(source);
    }
    expectAllIsTold(*closed);
    PointBatch batch;
    batch.position = std::vector{glm::dvec3(2)};
    EXPECT_FALSE(closed->read(batch).value());
    EXPECT_EQ(batch.size(), 0U);
    EXPECT_EQ(closed->glance().value().size(), 0U);
}

}  // namespace
}  // namespace scancast
