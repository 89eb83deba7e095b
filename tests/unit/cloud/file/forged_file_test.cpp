// Files whose checksums are right and whose content lies: none of it gets past open().
#include <gtest/gtest.h>

#include <limits>

#include "renderer/cloud/file/blocks/byte_planes.hpp"
#include "tests/support/clouds/version_two.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

using test::FileParts;
using Change = std::function<void(FileParts&)>;

/// A change to the node of one index.
Change node(std::size_t index, std::function<void(Node&)> change) {
    return [=](FileParts& file) { change(file.nodes[index].node); };
}

/// Another number of nodes, with places of planes for each.
Change changedCount(Change change) {
    return [=](FileParts& file) {
        change(file);
        file.planes.resize(file.nodes.size() * planesOf(file.facts).size(), file.planes.back());
    };
}

struct Lie {
    const char* what;
    Change change;
};

/// The honest file with a lie in it, in each version that has planes.
std::vector<std::vector<std::byte>> inEachVersion(std::span<const std::byte> honest, const Change& change) {
    return {test::forged(honest, change), test::asVersionTwo(honest, change)};
}

const std::vector<Lie>& lies() {
    static const std::vector<Lie> list{
        {"root with a parent", node(0, [](Node& n) { n.parent = 0; })},
        {"root below itself", node(0, [](Node& n) { n.firstChild = 0; })},
        {"level", node(1, [](Node& n) { n.level = 7; })},
        {"parent", node(1, [](Node& n) { n.parent = 1; })},
        {"more children than there are",
         node(0, [](Node& n) { n.childCount = 8, n.firstChild = 0xfffffff0u; })},
        {"nine children", node(0, [](Node& n) { n.childCount = 9; })},
        {"one child less", node(0, [](Node& n) { --n.childCount; })},
        {"no children", node(0, [](Node& n) { n.childCount = 0; })},
        {"points of the root", node(0, [](Node& n) { ++n.points; })},
        {"points of a child", node(1, [](Node& n) { ++n.points; })},
        {"points beyond counting", node(1, [](Node& n) { n.points = ~0ull; })},
        {"no samples", node(1, [](Node& n) { n.sampleCount = 0; })},
        {"a sample more", node(1, [](Node& n) { ++n.sampleCount; })},
        {"first sample", node(2, [](Node& n) { ++n.firstSample; })},
        {"box not a number", node(0, [](Node& n) { n.boxMin.x = nan; })},
        {"box without end", node(0, [](Node& n) { n.boxMax.y = infinity; })},
        {"box inside out", node(0, [](Node& n) { std::swap(n.boxMin, n.boxMax); })},
        {"center", node(0, [](Node& n) { n.center.z = -infinity; })},
        {"radius", node(0, [](Node& n) { n.radius = -1; })},
        {"radius not a number", node(0, [](Node& n) { n.radius = nan; })},
        {"step of zero", node(0, [](Node& n) { n.step.z = 0; })},
        {"step not a number", node(0, [](Node& n) { n.step.x = nan; })},
        {"step beyond numbers", node(0, [](Node& n) { n.step.x = 1e305; })},
        {"spacing of zero", node(0, [](Node& n) { n.spacing = 0; })},
        {"spacing not a number", node(0, [](Node& n) { n.spacing = float(nan); })},
        {"spacing above the parent's", node(1, [](Node& n) { n.spacing = 1e30F; })},
        {"mean spacing above spacing", node(0, [](Node& n) { n.meanSpacing = n.spacing * 2; })},
        {"mean spacing of zero", node(0, [](Node& n) { n.meanSpacing = 0; })},
        {"radius unit", node(0, [](Node& n) { n.radiusUnit = 0; })},
        {"cone", node(0, [](Node& n) { n.cone.axis.x = float(nan); })},
        {"cone angle", node(0, [](Node& n) { n.cone.halfAngle = -1; })},
        {"block in the header", [](FileParts& f) { f.nodes[1].samples.offset = 64; }},
        {"block in the index", [](FileParts& f) { f.nodes[1].samples.bytes += 1u << 30; }},
        {"block behind the file", [](FileParts& f) { f.nodes[1].samples.offset = ~0ull; }},
        {"no block", [](FileParts& f) { f.nodes[1].samples = {}; }},
        {"one node less", changedCount([](FileParts& f) { f.nodes.pop_back(); })},
        {"one node more", changedCount([](FileParts& f) { f.nodes.push_back(f.nodes.back()); })},
        {"points of the cloud", [](FileParts& f) { ++f.facts.points; }},
    };
    return list;
}

TEST(ForgedFile, EveryLieIsFound) {
    const auto honest = test::sampleFile();
    for (const auto& bytes : inEachVersion(honest, [](FileParts&) {}))
        ASSERT_TRUE(test::openBytes(bytes)) << "the forger must be good";
    for (const Lie& lie : lies())
        for (const auto& bytes : inEachVersion(honest, lie.change)) {
            const auto file = test::openBytes(bytes);
            ASSERT_FALSE(file) << lie.what;
            EXPECT_EQ(file.error().code, ErrorCode::Malformed) << lie.what;
            EXPECT_TRUE(file.error().message.starts_with("memory.scan, node ")) << file.error().message;
        }
}

TEST(ForgedFile, PhotosLieAmongTheBlocks) {
    const auto honest = test::sampleFile();
    const Change lies[] = {[](FileParts& f) { f.photos[1].offset = 127; },
                           [](FileParts& f) { f.photos[1].offset = ~0ull; },
                           [](FileParts& f) { f.photos[1].bytes = std::uint32_t(largestPhoto); }};
    for (const Change& lie : lies) {
        const auto file = test::openBytes(test::forged(honest, lie));
        ASSERT_FALSE(file);
        EXPECT_EQ(file.error().code, ErrorCode::Malformed);
        EXPECT_TRUE(file.error().message.starts_with("memory.scan, photo 1 is said to be at byte "))
            << file.error().message;
    }
}

// A leaf of 16 million samples whose block has 40 bytes would make readers allocate what the file does not
// hold.
TEST(ForgedFile, ABlockMustBeLargeEnoughForItsSamples) {
    const auto honest = test::sampleFile(false);
    const auto bytes = test::forged(honest, [](FileParts& file) {
        auto& nodes = file.nodes;
        Node leaf = nodes[0].node;
        leaf.childCount = 0, leaf.firstChild = noNode;
        leaf.sampleCount = 1u << 24, leaf.points = file.facts.points = 1u << 24;
        nodes = {{leaf, nodes[0].samples}};
        nodes[0].samples.bytes = 40;
    });
    const auto file = test::openBytes(bytes);
    ASSERT_FALSE(file);
    EXPECT_NE(file.error().message.find("too small"), std::string::npos) << file.error().message;
}

TEST(ForgedFile, HeadersThatContradictThemselves) {
    const std::vector<std::function<void(CloudFileHeader&)>> changes{
        [](auto& h) { h.nodes = 0; },
        [](auto& h) { h.nodes = 0xffffffffu; },
        [](auto& h) { ++h.nodes; },
        [](auto& h) { --h.index.bytes; },
        [](auto& h) { h.index.offset = 0; },
        [](auto& h) { h.index.offset = ~0ull; },
        [](auto& h) { ++h.index.offset; },
        [](auto& h) { --h.planes.offset; },
        [](auto& h) { ++h.planes.offset; },
        [](auto& h) { ++h.planes.bytes; },
        [](auto& h) { h.planes.bytes = ~0ull; },
        [](auto& h) { h.planes.bytes = ~0ull / h.nodes / planeRecordBytes * h.nodes * planeRecordBytes; },
        [](auto& h) { h.planes.bytes += 1000 * h.nodes * planeRecordBytes; },
        [](auto& h) { h.facts.offset = ~0ull - 5; },
        [](auto& h) { h.facts.offset = h.planes.offset, h.facts.bytes = h.fileBytes - h.facts.offset; },
        [](auto& h) { h.facts.bytes = ~0ull; },
        [](auto& h) { --h.facts.bytes; },
        [](auto& h) { --h.fileBytes; },
    };
    for (const auto& honest : inEachVersion(test::sampleFile(), [](FileParts&) {})) {
        const auto header = parseHeader(std::span(honest).first(cloudHeaderBytes), honest.size()).value();
        for (std::size_t i = 0; i < changes.size(); ++i) {
            auto bytes = honest;
            auto changed = header;
            changes[i](changed);
            const auto start = encodeHeader(changed);
            std::copy(start.begin(), start.end(), bytes.begin());
            const auto file = test::openBytes(bytes);
            ASSERT_FALSE(file) << i;
            EXPECT_EQ(file.error().code, ErrorCode::Malformed) << i << ": " << file.error().message;
        }
    }
}

/// A change to one plane of one node.
Change plane(std::size_t node, std::size_t index, std::function<void(BlockPlace&)> change) {
    return [=](FileParts& file) { change(file.planes[node * planesOf(file.facts).size() + index]); };
}

struct PlaneLie {
    Change change;
    std::string where, what;
};

// The sample file's planes: three columns, then companions of all samples. Its root is an inner node, its last node
// a leaf.
TEST(ForgedFile, EveryLieAboutPlanesIsFoundAndNamed) {
    const auto honest = test::sampleFile();
    const auto file = test::openBytes(honest).value();
    const std::size_t last = file->nodes().size() - 1;
    const std::string leaf = "node " + std::to_string(last) + " of the index, plane return_number: ";
    const auto someBlock = file->planePlace(std::uint32_t(last), 0);
    const std::vector<PlaneLie> lies{
        {plane(last, 1, [](BlockPlace& p) { p = {}; }), leaf, "a block is missing"},
        {plane(last, 1, [](BlockPlace& p) { p.bytes = 0; }), leaf, "a block is missing"},
        {plane(last, 1, [](BlockPlace& p) { p.offset = 64; }), leaf, "outside"},
        {plane(last, 1, [](BlockPlace& p) { p.offset = ~0ull; }), leaf, "outside"},
        {plane(last, 1, [](BlockPlace& p) { p.bytes = 0xffffffffu; }), leaf, "outside"},
        {plane(0, 1, [=](BlockPlace& p) { p = someBlock; }),
         "node 0 of the index, plane return_number: ", "a block of nothing"},
        {plane(0, 3, [](BlockPlace& p) { p.bytes = 0; }), "node 0 of the index, plane density: ", "missing"},
        {plane(0, 3, [](BlockPlace& p) { p.offset = 0; }), "node 0 of the index, plane density: ", "outside"},
    };
    for (const PlaneLie& lie : lies)
        for (const auto& bytes : inEachVersion(honest, lie.change)) {
            const auto forged = test::openBytes(bytes);
            ASSERT_FALSE(forged) << lie.where << lie.what;
            EXPECT_EQ(forged.error().code, ErrorCode::Malformed);
            EXPECT_TRUE(forged.error().message.starts_with("memory.scan, " + lie.where))
                << forged.error().message;
            EXPECT_NE(forged.error().message.find(lie.what), std::string::npos) << forged.error().message;
        }
}

TEST(ForgedFile, ThereIsAPlaceForEachPlaneOfEachNode) {
    const auto honest = test::sampleFile();
    const Change lies[] = {
        [](FileParts& f) { f.planes.resize(f.planes.size() - f.nodes.size()); },
        [](FileParts& f) { f.planes.resize(f.planes.size() + f.nodes.size(), f.planes.back()); },
        [](FileParts& f) { f.facts.companions.pop_back(); },
        [](FileParts& f) { f.facts.companions.clear(), f.facts.columns.clear(); },
        [](FileParts& f) { f.planes.clear(); }};
    for (const Change& lie : lies)
        for (const auto& bytes : inEachVersion(honest, lie)) {
            const auto forged = test::openBytes(bytes);
            ASSERT_FALSE(forged);
            EXPECT_EQ(forged.error().code, ErrorCode::Malformed);
            EXPECT_NE(forged.error().message.find("the index of planes "), std::string::npos)
                << forged.error().message;
        }
}

TEST(ForgedFile, PlanesMustBeLargeEnoughForTheirValues) {
    const auto honest = test::sampleFile();
    const auto bytes = test::forged(honest, [](FileParts& file) {
        Node leaf = file.nodes[0].node;
        leaf.childCount = 0, leaf.firstChild = noNode;
        leaf.sampleCount = 1u << 24, leaf.points = file.facts.points = 1u << 24;
        // Samples that could decode to 16 million, by their length.
        file.nodes = {{leaf, {cloudHeaderBytes, 1u << 15, 0}}};
        file.facts.companions.clear();
        file.planes.assign(3, BlockPlace{cloudHeaderBytes, 100, 0});
    });
    const auto file = test::openBytes(bytes);
    ASSERT_FALSE(file);
    EXPECT_NE(file.error().message.find("plane gps_time: a block is too small"), std::string::npos)
        << file.error().message;
}

TEST(ForgedFile, WhatMustBeZeroIsLookedAt) {
    const auto honest = test::sampleFile();
    const auto header = parseHeader(std::span(honest).first(cloudHeaderBytes), honest.size()).value();
    const auto parts = test::partsOf(honest);
    const auto blocks = std::span(honest).first(header.index.offset),
               facts = std::span(honest).subspan(header.facts.offset);
    const auto nodes = residualsOf(parts.nodes),
               planes = residualsOf(parts.planes, parts.nodes, planesOf(parts.facts).size());
    ASSERT_EQ(test::packedFile(blocks, nodes, planes, facts), honest);
    for (const std::size_t at : {143, 184, 207}) {
        auto other = nodes;
        other[nodeRecordBytes + at] = std::byte(1);
        const auto file = test::openBytes(test::packedFile(blocks, other, planes, facts));
        ASSERT_FALSE(file) << at;
        EXPECT_NE(file.error().message.find("index of nodes has something where zeros"), std::string::npos)
            << file.error().message;
    }
    for (const std::size_t at : {20, 23}) {
        auto other = planes;
        other[planeRecordBytes + at] = std::byte(1);
        const auto file = test::openBytes(test::packedFile(blocks, nodes, other, facts));
        ASSERT_FALSE(file) << at;
        EXPECT_NE(file.error().message.find("index of planes has something where zeros"), std::string::npos)
            << file.error().message;
    }
}

}  // namespace
}  // namespace scancast
