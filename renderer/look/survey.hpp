// A thin, even sample of a whole cloud, from which its look is decided: points of the surface about equally
// far apart, whatever the scan's own density. Taken from the upper levels of the octree, so it costs the same
// for any cloud. Pipeline: octree → **survey** → scene → look.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

struct SurveyPoint {
    glm::dvec3 position;  ///< file coordinates
    glm::vec3 normal;     ///< unit length; 0 where there is none. Its sign says little
    float spacing = 0;    ///< of the node that it is from
    std::uint8_t classification = 0;
};

/// At most `most` points, the same on any machine; none when no block can be read.
std::vector<SurveyPoint> survey(const Cloud& cloud, std::size_t most);

/// Median deviation of a point's nearest neighbours from the paraboloid through them, in leaves all over the cloud; 0 for
/// clouds of few points. Cloud units.
double noiseOf(const Cloud& cloud);

/// Without what lies far from everything, and without the noise classes 7 and 18 unless there is nothing
/// else: what a picture should show. Never empty where `points` is not.
std::vector<SurveyPoint> withoutStrays(std::vector<SurveyPoint> points);

/// Least and greatest coordinates. `points` is not empty.
std::array<glm::dvec3, 2> boxOf(const std::vector<SurveyPoint>& points);

/// The value below which the share `q` of them lies. `values` is not empty.
double quantileOf(std::vector<double> values, double q);

}  // namespace scancast
