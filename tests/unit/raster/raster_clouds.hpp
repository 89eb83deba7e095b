// A cloud that tests of rasters look at, and its points.
#pragma once

#include <memory>
#include <vector>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/raster/raster_plan.hpp"
#include "tests/support/clouds/synthetic_source.hpp"
#include "tests/support/sized.hpp"

namespace scancast::test {

/// Ground with three classes and a round hole, in UTM coordinates, on a grid of millimetres.
inline ScanPoint surveyed(std::uint64_t i, std::uint64_t) {
    ScanPoint p;
    double x = 120 * uniform(i, 1), y = 90 * uniform(i, 2);
    if (std::hypot(x - 40, y - 40) < 6) x += 60;
    p.position = {389400 + x, 5819700 + y, 34 + std::sin(x / 9) * std::cos(y / 7) * 5 + uniform(i, 3)};
    p.classification = std::uint8_t(2 + i % 3);
    return p;
}

struct SurveyedCloud {
    std::vector<ScanPoint> points;
    std::shared_ptr<const Cloud> cloud;
};

inline SurveyedCloud surveyedCloud() {
    const std::uint64_t count = sized(60'000, 8'000);
    SurveyedCloud result;
    const glm::dvec3 origin(0);
    for (std::uint64_t i = 0; i < count; ++i) {
        result.points.push_back(surveyed(i, count));
        for (int a = 0; a < 3; ++a)  // as the source rounds them
            result.points.back().position[a] =
                origin[a] + 0.001 * std::nearbyint((result.points.back().position[a] - origin[a]) / 0.001);
    }
    SyntheticSource source(count, surveyed, Attributes{.classification = true}, 0.001);
    BuildOptions options;
    options.shape.leafPoints = 2000;
    result.cloud = *buildCloud(source, options);
    return result;
}

/// Of all points, those too that stand alone.
inline RasterRequest requested(RasterKind kind, WordValues words) {
    words.emplace_back("outliers", "show");
    return rasterRequestOf(kind, words).value();
}

}  // namespace scancast::test
