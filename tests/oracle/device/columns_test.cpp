// Pictures coloured and filtered by columns, in every method, against brute force: in a copy of the cloud each sample's class says
// whether it lies in all ranges, and its intensity where on the colour map its value stands, by the points that the scan was made of.
// Drawn by class and intensity, which know nothing of columns, that copy must give the same bytes.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "protocol/view/view_words.hpp"
#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "renderer/pick/pick.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/open_cloud.hpp"
#include "tests/support/clouds/column_source.hpp"
#include "tests/support/pictures/devices.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

constexpr std::uint64_t columnPoints = 12'000;
constexpr std::uint8_t stays = 1, goes = 2;

OctreeShape columnShape() {
    OctreeShape made;
    made.leafPoints = 700;
    made.surfels = true;
    return made;
}

struct ColumnClouds {
    std::shared_ptr<const Cloud> inMemory, inFile;
    TemporaryFolder folder;
    std::shared_ptr<BlockCache> cache;

    ColumnClouds() {
        BuildOptions building;
        building.shape = columnShape();
        ColumnSource source(columnPoints, ball);
        inMemory = buildCloud(source, building, {}).value();
        IngestOptions options;
        options.shape = columnShape();
        options.output = folder / "columns.scan";
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::make_unique<ColumnSource>(columnPoints, ball));
        EXPECT_TRUE(ingest(std::move(sources), options, {}, {}));
        BlockCacheOptions room;
        room.memoryLimit = std::uint64_t(256) << 20;
        cache = BlockCache::create(room);
        inFile = openCloud(options.output, cache).value();
    }
};

/// The number of the point that each sample stands for: a leaf's own, by its row; an inner node's, the one of the sample below that is
/// nearest, found by comparing with all of them.
std::vector<std::vector<std::uint32_t>> numbersOf(const Cloud& cloud) {
    const auto file = cloud.octree.store().cloudFile();
    const auto nodes = cloud.octree.nodes();
    std::vector<std::vector<std::uint32_t>> numbers(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) {
        if (nodes[i].isLeaf()) {
            const auto rows = file->rows(std::uint32_t(i)).value();
            for (std::size_t at = 0; at < rows.size(); at += 17)
                numbers[i].push_back(loadLe<std::uint32_t>(rows.data() + at + 13));
            continue;
        }
        std::vector<std::pair<glm::dvec3, std::uint32_t>> below;
        for (std::uint32_t c = nodes[i].firstChild; c < nodes[i].firstChild + nodes[i].childCount; ++c) {
            const auto run = cloud.octree.run(c).value();
            for (std::size_t s = 0; s < run.samples.size(); ++s)
                below.emplace_back(position(nodes[c], run.samples[s]), numbers[c][s]);
        }
        const auto run = cloud.octree.run(std::uint32_t(i)).value();
        for (const Sample& sample : run.samples) {
            const glm::dvec3 p = position(nodes[i], sample);
            double least = 1e300;
            std::uint32_t nearest = 0;
            for (const auto& [place, number] : below) {
                const glm::dvec3 way = place - p;
                const double distance = way.x * way.x + way.y * way.y + way.z * way.z;
                if (distance < least) least = distance, nearest = number;
            }
            numbers[i].push_back(nearest);
        }
    }
    return numbers;
}

/// `code` and `stays` of (the point's number, the sample).
template <class Code, class Stays>
std::shared_ptr<const Cloud> toldOf(const Cloud& cloud, Code code, Stays isLeft) {
    const Octree& octree = cloud.octree;
    const bool hasFile = octree.store().cloudFile() != nullptr;
    const auto numbers = hasFile ? numbersOf(cloud) : std::vector<std::vector<std::uint32_t>>();
    auto told = std::make_shared<Cloud>(cloud);
    std::vector<Sample> samples(octree.sampleCount());
    std::vector<BesideWord> beside;
    for (std::uint32_t i = 0; i < octree.nodes().size(); ++i) {
        const Node& node = octree.node(i);
        const auto run = octree.run(i).value();
        if (!run.beside.empty()) beside.resize(samples.size());
        std::ranges::copy(run.beside,
                          beside.begin() + std::ptrdiff_t(run.beside.empty() ? 0 : node.firstSample));
        for (std::size_t s = 0; s < run.samples.size(); ++s) {
            const std::uint32_t number = hasFile ? numbers[i][s] : 0;
            Sample& to = samples[node.firstSample + s] = run.samples[s];
            to.classification = isLeft(number, run.samples[s]) ? stays : goes;
            to.intensity = code(number, run.samples[s]);
        }
    }
    told->octree =
        Octree({octree.nodes().begin(), octree.nodes().end()}, std::move(samples), std::move(beside));
    return told;
}

class Columns : public OnDevice {
  protected:
    static void SetUpTestSuite() { clouds_ = std::make_unique<ColumnClouds>(); }
    static void TearDownTestSuite() { clouds_.reset(); }
    static std::unique_ptr<ColumnClouds> clouds_;

    Frame picture(const Cloud& cloud, const WordValues& words, const char* detail) const {
        View view = defaultView(*clouds_->inFile, 96, 72);
        view = applyWords(view, words).value();
        view.quality.samples = 1;
        view.quality.detail = std::atof(detail);
        auto frame = render(*device_, cloud, view, {.wait = true});
        EXPECT_TRUE(frame) << frame.error().message;
        return frame ? std::move(*frame) : Frame();
    }
    /// In every method, of the leaves and of the root alone.
    void compare(const Cloud& cloud, WordValues asked, const Cloud& told, WordValues byClass) const {
        for (const Method& method : methods()) {
            if (method.name == automaticName) continue;
            if (slow_ && method.name != "paraboloid" && method.name != "ewa" && method.name != "point")
                continue;
            for (const char* detail : {"0", "1024"}) {
                SCOPED_TRACE(method.name + ", detail " + detail);
                WordValues these = asked, those = byClass;
                these.emplace_back("method", method.name);
                those.emplace_back("method", method.name);
                const Frame frame = picture(cloud, these, detail), brute = picture(told, those, detail);
                ASSERT_FALSE(frame.rgba.empty());
                EXPECT_TRUE(frame.rgba == brute.rgba && frame.depth == brute.depth);
                const auto seen =
                    std::ranges::count_if(frame.depth, [](float d) { return std::isfinite(d); });
                EXPECT_GT(seen, 50);
            }
        }
    }
};
std::unique_ptr<ColumnClouds> Columns::clouds_;
SCANCAST_ON_DEVICES(Columns, "egl");

const WordValues told{{"classes", "1"}, {"color", "intensity"}, {"range", "0,65535"}, {"colormap", "turbo"}};

std::uint16_t codeBetween(double value, double low, double high) {
    if (!(value == value)) return 0;
    return std::uint16_t(std::lround(65535 * std::clamp((value - low) / (high - low), 0.0, 1.0)));
}

TEST_P(Columns, AreWhatBruteForceFinds) {
    const auto brute = toldOf(
        *clouds_->inFile, [](std::uint32_t i, const Sample&) { return codeBetween(amountOf(i), -50, 350); },
        [](std::uint32_t i, const Sample& s) {
            return returnsOf(i) >= 1 && returnsOf(i) <= 3 && shotOf(i) <= 700 && s.intensity >= 400;
        });
    compare(*clouds_->inFile,
            {{"color", "column:amount"},
             {"range", "-50,350"},
             {"colormap", "turbo"},
             {"filter", "returns:1..3;shot%3B time:..700;intensity:400.."}},
            *brute, told);
}

TEST_P(Columns, StandBesideClassesAndClips) {
    const auto brute = toldOf(
        *clouds_->inFile, [](std::uint32_t i, const Sample&) { return codeBetween(shotOf(i), 0, 1000); },
        [](std::uint32_t i, const Sample& s) {
            return amountOf(i) >= 0 && (s.classification == 2 || s.classification == 4);
        });
    WordValues clipped = told;
    clipped.emplace_back("clips", "plane:0,0,-2,0.2,0.3,1");
    compare(*clouds_->inFile,
            {{"color", "column:shot; time"},
             {"range", "0,1000"},
             {"colormap", "turbo"},
             {"filter", "amount:0.."},
             {"classes", "2,4"},
             {"clips", "plane:0,0,-2,0.2,0.3,1"}},
            *brute, clipped);
}

TEST_P(Columns, OfSamplesWorkInMemoryToo) {
    const auto brute = toldOf(
        *clouds_->inMemory,
        [](std::uint32_t, const Sample& s) { return codeBetween(s.intensity, 500, 2500); },
        [](std::uint32_t, const Sample& s) {
            return s.classification >= 3 && s.intensity >= 300 && s.intensity <= 2800;
        });
    compare(*clouds_->inMemory,
            {{"color", "column:intensity"},
             {"range", "500,2500"},
             {"colormap", "turbo"},
             {"filter", "classification:3..;intensity:300..2800"}},
            *brute, told);
}

// What is in the shadow of what, and what mirrors show, follows from what is drawn: nothing else may change.
TEST_P(Columns, LeaveColoursAloneWhereTheyOnlyFilter) {
    const auto brute = toldOf(
        *clouds_->inFile, [](std::uint32_t, const Sample& s) { return s.intensity; },
        [](std::uint32_t i, const Sample&) { return amountOf(i) <= 250.5; });
    for (const char* color : {"rgb", "rgb*intensity", "elevation"})
        EXPECT_TRUE(picture(*clouds_->inFile,
                            {{"method", "paraboloid"},
                             {"color", color},
                             {"filter", "amount:..250.5"},
                             {"light.sun", "130,40"},
                             {"light.shadow", "0.7"}},
                            "0")
                        .rgba == picture(*brute,
                                         {{"method", "paraboloid"},
                                          {"color", color},
                                          {"classes", "1"},
                                          {"light.sun", "130,40"},
                                          {"light.shadow", "0.7"}},
                                         "0")
                                     .rgba)
            << color;
}

TEST_P(Columns, PicksArePointsThatAreDrawnWithAllThatTheyAre) {
    View view = defaultView(*clouds_->inFile, 96, 72);
    view = applyWords(view, {{"method", "point"},
                             {"color", "column:amount"},
                             {"filter", "returns:2..2;amount:0..300"},
                             {"detail", "0"},
                             {"samples", "1"}})
               .value();
    const Frame frame = render(*device_, *clouds_->inFile, view).value();
    int picks = 0;
    for (int y = 0; y < 72; ++y)
        for (int x = 0; x < 96; ++x) {
            const float depth = frame.depth[std::size_t(y) * 96 + std::size_t(x)];
            if (!std::isfinite(depth) || ++picks > 40) continue;
            const auto picked = pick(*clouds_->inFile, view, {x, y}, depth);
            ASSERT_TRUE(picked && *picked) << (picked ? "nothing" : picked.error().message);
            const KeptPoint& point = (*picked)->point;
            ASSERT_EQ(point.row.size(), 17u);
            const auto number = loadLe<std::uint32_t>(point.row.data() + 13);
            EXPECT_EQ(returnsOf(number), 2);
            EXPECT_GE(amountOf(number), 0);
            EXPECT_LE(amountOf(number), 300);
            EXPECT_EQ((*picked)->sample.intensity, intensityOf(number)) << "not the column's code";
            EXPECT_LT(glm::distance(point.position, ball(number, columnPoints).position), 0.002);
        }
    EXPECT_GT(picks, 20);
}

}  // namespace
}  // namespace scancast::test
