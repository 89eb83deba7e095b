// What a cloud file knows of its columns: how their values are distributed, and what inner nodes' samples have of them. Right because both are
// counted and searched again, one by one, in what the scan was made of.
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "renderer/cloud/build/histogram_parts.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/columns/pictured_file.hpp"
#include "renderer/cloud/columns/stored_values.hpp"
#include "renderer/cloud/file/change_facts.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "tests/support/clouds/column_source.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scancast::test {
namespace {

constexpr std::uint64_t count = 12'000;

class KeptColumns : public ::testing::Test {
  protected:
    std::shared_ptr<const CloudFile> ingested(const std::string& name,
                                              const std::string& lastColumn = "number", int threads = 2,
                                              bool exact = false) {
        IngestOptions options;
        options.shape.leafPoints = 700;
        options.shape.surfels = false;
        options.shape.exact = exact;
        options.output = folder_ / name;
        options.title = "columns";
        options.threads = threads;
        std::vector<std::unique_ptr<PointSource>> sources;
        sources.push_back(std::make_unique<ColumnSource>(count, ball, lastColumn));
        const auto report = ingest(std::move(sources), options, {}, {});
        EXPECT_TRUE(report) << report.error().message;
        return CloudFile::open(folder_ / name).value();
    }
    const TemporaryFolder folder_;
};

TEST_F(KeptColumns, HistogramsCountEveryPoint) {
    const auto file = ingested("a.scan");
    const auto& columns = file->facts().columns;
    const auto countAgain = [](const ValueHistogram& histogram, auto valueOf) {
        std::vector<std::uint64_t> counts(histogram.counts.size());
        const double width = (histogram.high - histogram.low) / double(counts.size());
        for (std::uint64_t i = 0; i < count; ++i) {
            const double value = valueOf(i);
            if (!(value >= histogram.low && value <= histogram.high)) continue;
            ++counts[std::min(std::size_t((value - histogram.low) / width), counts.size() - 1)];
        }
        return counts;
    };
    const auto& returns = columns[2].histogram.value();
    EXPECT_EQ(returns.low, 0.5);
    EXPECT_EQ(returns.high, 5.5);
    EXPECT_EQ(returns.counts, countAgain(returns, returnsOf)) << "one part for each whole number, exactly";
    EXPECT_EQ(returns.counts.size(), 5u);
    // Of others, what lies within a cell's width - a two-thousandth - of a part's end may be on its other side.
    for (const auto& [column, valueOf] :
         {std::pair<std::size_t, double (*)(std::uint64_t)>{0, amountOf}, {1, shotOf}}) {
        const auto& histogram = columns[column].histogram.value();
        EXPECT_EQ(histogram.low, columns[column].usual->at(0));
        EXPECT_EQ(histogram.high, columns[column].usual->at(1));
        ASSERT_EQ(histogram.counts.size(), 64u);
        const auto again = countAgain(histogram, valueOf);
        for (std::size_t part = 0; part < 64; ++part)
            EXPECT_NEAR(double(histogram.counts[part]), double(again[part]), 0.002 * double(count)) << part;
    }
    const auto& intensities = file->facts().intensityHistogram.value();
    EXPECT_EQ(intensities.counts,
              countAgain(intensities, [](std::uint64_t i) { return double(intensityOf(i)); }));
}

TEST_F(KeptColumns, InnerNodesHaveTheNearestPointsValues) {
    const auto file = ingested("a.scan");
    const auto planes = file->planes();
    ASSERT_EQ(planes.size(), 4u + file->facts().companions.size());
    const auto innerOf = [&](std::size_t column) {
        const auto at = std::ranges::find(planes, innerPlane(file->facts().columns[column].column));
        EXPECT_NE(at, planes.end());
        return std::size_t(at - planes.begin());
    };
    std::vector<std::vector<double>> numbers(file->nodes().size());
    std::size_t inner = 0;
    for (std::size_t i = file->nodes().size(); i-- > 0;) {
        const Node& node = file->nodes()[i].node;
        const auto values = [&](std::size_t column) {
            return valuesOf(file->plane(std::uint32_t(i), node.isLeaf() ? column : innerOf(column)).value(),
                            file->facts().columns[column].column);
        };
        numbers[i] = values(3);
        const auto samples = file->samples(std::uint32_t(i)).value();
        ASSERT_EQ(numbers[i].size(), samples.size());
        if (node.isLeaf()) {
            EXPECT_TRUE(file->plane(std::uint32_t(i), innerOf(3)).value().empty()) << "theirs is the column";
            continue;
        }
        ++inner;
        const auto amounts = values(0), shots = values(1), returns = values(2);
        std::vector<std::pair<glm::dvec3, double>> below;
        for (std::uint32_t c = node.firstChild; c < node.firstChild + node.childCount; ++c) {
            const auto some = file->samples(c).value();
            for (std::size_t s = 0; s < some.size(); ++s)
                below.emplace_back(position(file->nodes()[c].node, some[s]), numbers[c][s]);
        }
        for (std::size_t s = 0; s < samples.size(); ++s) {
            const glm::dvec3 p = position(node, samples[s]);
            double least = 1e300, nearest = -1;
            for (const auto& [place, number] : below) {
                const glm::dvec3 way = place - p;
                const double distance = way.x * way.x + way.y * way.y + way.z * way.z;
                if (distance < least) least = distance, nearest = number;
            }
            ASSERT_EQ(numbers[i][s], nearest) << "node " << i << ", sample " << s;
            const auto number = std::uint64_t(nearest);
            EXPECT_DOUBLE_EQ(amounts[s], amountOf(number)) << "all of one point";
            EXPECT_EQ(returns[s], returnsOf(number));
            const double shot = shotOf(number);
            EXPECT_TRUE(shots[s] == shot || (std::isnan(shots[s]) && std::isnan(shot)));
        }
    }
    EXPECT_GT(inner, 5u);
}

TEST_F(KeptColumns, AreTheSameWhateverTheThreads) {
    ingested("a.scan", "number", 1);
    ingested("b.scan", "number", 5);
    const auto bytes = [&](const char* name) {
        std::ifstream in(folder_ / name, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    EXPECT_TRUE(bytes("a.scan") == bytes("b.scan"));
}

TEST_F(KeptColumns, OfOneNameTheFirstIsMeant) {
    const auto file = ingested("a.scan", "amount");
    const auto chosen = choosableColumns(file->facts());
    EXPECT_EQ(chosen, (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_EQ(std::ranges::count_if(file->facts().companions,
                                    [](const ValuePlane& plane) { return plane.name.starts_with("inner:"); }),
              3);
}

TEST_F(KeptColumns, StayWhenFactsAreChanged) {
    const CloudFacts before = ingested("a.scan")->facts();
    ASSERT_TRUE(changeFacts(folder_ / "a.scan", [](CloudFacts& facts) -> Expected<void> {
        facts.title = "another";
        return {};
    }));
    const CloudFacts after = CloudFile::open(folder_ / "a.scan").value()->facts();
    EXPECT_EQ(after.title, "another");
    EXPECT_EQ(after.columns, before.columns);
    EXPECT_EQ(after.intensityHistogram, before.intensityHistogram);
    EXPECT_EQ(after.companions, before.companions);
}

TEST_F(KeptColumns, WhatThereIsNotIsSaidWithWhatThereIs) {
    const CloudFacts facts = ingested("a.scan")->facts();
    const auto refused = [&](const CloudFacts& of, const char* name, bool inner = true) {
        const auto choice = chooseColumns(of, ColumnRanges{{name, 1.0, {}}}, inner);
        EXPECT_FALSE(choice);
        EXPECT_EQ(choice.error().code, ErrorCode::Unsupported);
        EXPECT_EQ(choice.error().field, "filter");
        return choice.error().message;
    };
    const std::string message = refused(facts, "amonut");
    for (const char* name : {"amonut", "amount", "shot; time", "returns", "intensity", "classification"})
        EXPECT_NE(message.find(name), std::string::npos) << message;
    // A cloud file of before, whose inner nodes have no values.
    CloudFacts older = facts;
    std::erase_if(older.companions, [](const ValuePlane& plane) { return plane.name.starts_with("inner:"); });
    EXPECT_NE(refused(older, "amount").find("ingest the scan again with --keep-attributes"),
              std::string::npos);
    EXPECT_TRUE(chooseColumns(older, ColumnRanges{{"amount", 1.0, {}}}, false)) << "leaves alone have them";
    EXPECT_TRUE(chooseColumns(older, ColumnRanges{{"intensity", 1.0, {}}}, true));
    CloudFacts none;
    EXPECT_NE(refused(none, "amount").find("--keep-attributes"), std::string::npos);
    EXPECT_NE(refused(none, "intensity").find("no column"), std::string::npos);
}

TEST(HistogramParts, AreWhereTheValuesAre) {
    EXPECT_EQ(histogramParts({1, 64}, {2, 50}, 1).count, 64u);
    EXPECT_TRUE(histogramParts({1, 64}, {2, 50}, 1).whole);
    const HistogramParts many = histogramParts({0, 1e9}, {10, 20}, 1);
    EXPECT_EQ(many.low, 10);
    EXPECT_EQ(many.high, 20);
    const HistogramParts one = histogramParts({3.5, 3.5}, {3.5, 3.5}, 0);
    EXPECT_LT(one.low, one.high);
    ValueHistogram counted = one.empty();
    addTo(counted, 3.5, 7);
    addTo(counted, 100, 7);
    EXPECT_EQ(counted.counts, std::vector<std::uint64_t>{7});
}

TEST(ColumnCodes, GoFromEndToEnd) {
    EXPECT_EQ(codeOf(-1, {0, 10}), 0);
    EXPECT_EQ(codeOf(5, {0, 10}), 32768);
    EXPECT_EQ(codeOf(10, {0, 10}), 65535);
    EXPECT_EQ(codeOf(1e300, {0, 10}), 65535);
    EXPECT_EQ(codeOf(std::nan(""), {0, 10}), 0);
    EXPECT_EQ(codeOf(3, {3, 3}), 0);
}

}  // namespace
}  // namespace scancast::test
