// Reads a scan to its end and says what was in it; checks on the way that every batch keeps the promises of
// PointSource. For tests.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cctype>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <set>
#include <string>

#include "renderer/cloud/point_batch.hpp"

namespace scancast::test {

struct ScanSummary {
    std::uint64_t points = 0;
    glm::dvec3 min{1e300}, max{-1e300};
    std::array<int, 2> intensity{65536, -1};
    std::set<int> classes;
    int colorMax = -1;
    std::set<std::array<std::uint8_t, 3>> colors;  ///< at most 1,000 different ones
    std::uint64_t normals = 0;                     ///< those that are not 0
    PointBatch first;                              ///< the first batch
};

inline void take(const PointBatch& batch, const Attributes& has, ScanSummary& summary) {
    const auto n = batch.size();
    ASSERT_GT(n, 0U);
    ASSERT_LE(n, PointSource::batchPoints);
    ASSERT_EQ(batch.color.size(), has.color ? n : 0);
    ASSERT_EQ(batch.intensity.size(), has.intensity ? n : 0);
    ASSERT_EQ(batch.classification.size(), has.classification ? n : 0);
    ASSERT_EQ(batch.normal.size(), has.normal ? n : 0);
    if (summary.points == 0) summary.first = batch;
    summary.points += n;
    for (const auto& p : batch.position) {
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
        summary.min = glm::min(summary.min, p);
        summary.max = glm::max(summary.max, p);
    }
    for (const int i : batch.intensity)
        summary.intensity = {std::min(summary.intensity[0], i), std::max(summary.intensity[1], i)};
    for (const int c : batch.classification) summary.classes.insert(c);
    for (const auto& c : batch.color) {
        summary.colorMax = std::max({summary.colorMax, int(c[0]), int(c[1]), int(c[2])});
        if (summary.colors.size() < 1000) summary.colors.insert(c);
    }
    for (const auto& normal : batch.normal) {
        const auto length = glm::length(normal);
        ASSERT_TRUE(length == 0 || std::abs(length - 1) < 1e-3F);
        summary.normals += length > 0;
    }
}

/// The error that reading ends with, or the summary.
inline Expected<ScanSummary> summarize(PointSource& source) {
    ScanSummary summary;
    PointBatch batch;
    for (;;) {
        const auto more = source.read(batch);
        if (!more) return passOn(more);
        if (!*more) break;
        take(batch, source.header().attributes, summary);
        if (::testing::Test::HasFatalFailure())
            return fail(ErrorCode::Internal, "a batch breaks its promises");
    }
    EXPECT_EQ(batch.size(), 0U);
    return summary;
}

/// openScan and read to the end, whichever fails first.
template <class Source>
Expected<ScanSummary> summarizeOpened(Expected<std::unique_ptr<Source>> source) {
    if (!source) return passOn(source);
    return summarize(**source);
}

/// A test's name from the `file` of its parameter.
template <class Param>
std::string fileAsTestName(const ::testing::TestParamInfo<Param>& test) {
    std::string name = test.param.file;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

}  // namespace scancast::test
