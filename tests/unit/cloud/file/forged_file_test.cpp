// Files whose checksums are right and whose content lies: none of it gets past open().
#include <gtest/gtest.h>

#include <limits>

#include "renderer/cloud/file/byte_planes.hpp"
#include "tests/unit/cloud/file/sample_cloud.hpp"

namespace scancast {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

using Change = std::function<void(std::vector<StoredNode>&, CloudFacts&)>;
using Nodes = std::vector<StoredNode>;

/// A change to the node of one index.
Change node(std::size_t index, std::function<void(Node&)> change) {
    return [=](Nodes& nodes, CloudFacts&) { change(nodes[index].node); };
}

struct Lie {
    const char* what;
    Change change;
};

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
        {"block in the header", [](Nodes& n, CloudFacts&) { n[1].samples.offset = 64; }},
        {"block in the index", [](Nodes& n, CloudFacts&) { n[1].samples.bytes += 1u << 30; }},
        {"block behind the file", [](Nodes& n, CloudFacts&) { n[1].samples.offset = ~0ull; }},
        {"no block", [](Nodes& n, CloudFacts&) { n[1].samples = {}; }},
        {"no rows", [](Nodes& n, CloudFacts&) { n.back().rows = {}; }},
        {"rows in the header", [](Nodes& n, CloudFacts&) { n.back().rows.offset = 0; }},
        {"rows of an inner node", [](Nodes& n, CloudFacts&) { n[0].rows = n.back().rows; }},
        {"one node less", [](Nodes& n, CloudFacts&) { n.pop_back(); }},
        {"one node more", [](Nodes& n, CloudFacts&) { n.push_back(n.back()); }},
        {"points of the cloud", [](Nodes&, CloudFacts& f) { ++f.points; }},
        {"columns that no node has",
         [](Nodes& n, CloudFacts&) {
             for (auto& s : n) s.rows = {};
         }},
    };
    return list;
}

TEST(ForgedFile, EveryLieIsFound) {
    const auto honest = test::sampleFile();
    ASSERT_TRUE(test::openBytes(test::forged(honest, [](Nodes&, CloudFacts&) {})))
        << "the forger must be good";
    for (const Lie& lie : lies()) {
        const auto bytes = test::forged(honest, lie.change);
        const auto file = test::openBytes(bytes);
        ASSERT_FALSE(file) << lie.what;
        EXPECT_EQ(file.error().code, ErrorCode::Malformed) << lie.what;
        EXPECT_TRUE(file.error().message.starts_with("memory.scan, node ")) << file.error().message;
    }
}

// A leaf of 16 million samples whose block has 40 bytes would make readers allocate what the file does not
// hold.
TEST(ForgedFile, ABlockMustBeLargeEnoughForItsSamples) {
    const auto honest = test::sampleFile(false);
    const auto bytes = test::forged(honest, [](Nodes& nodes, CloudFacts& facts) {
        Node leaf = nodes[0].node;
        leaf.childCount = 0, leaf.firstChild = noNode;
        leaf.sampleCount = 1u << 24, leaf.points = facts.points = 1u << 24;
        nodes = {{leaf, nodes[0].samples, {}}};
        nodes[0].samples.bytes = 40;
    });
    const auto file = test::openBytes(bytes);
    ASSERT_FALSE(file);
    EXPECT_NE(file.error().message.find("too small"), std::string::npos) << file.error().message;
}

TEST(ForgedFile, HeadersThatContradictThemselves) {
    const auto honest = test::sampleFile();
    const auto header = parseHeader(std::span(honest).first(cloudHeaderBytes), honest.size()).value();
    const std::vector<std::function<void(CloudFileHeader&)>> changes{
        [](auto& h) { h.nodes = 0; },
        [](auto& h) { h.nodes = 0xffffffffu; },
        [](auto& h) { ++h.nodes; },
        [](auto& h) { h.index.offset = 0; },
        [](auto& h) { h.index.offset = ~0ull; },
        [](auto& h) { ++h.index.offset; },
        [](auto& h) { h.factsOffset = ~0ull - 5; },
        [](auto& h) { h.factsBytes = ~0ull; },
        [](auto& h) { --h.factsBytes; },
        [](auto& h) { --h.fileBytes; },
    };
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

}  // namespace
}  // namespace scancast
