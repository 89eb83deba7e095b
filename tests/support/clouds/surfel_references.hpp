// Surfels as other libraries compute them: what estimateSurfels() is compared with, in agreement by the
// oracle tests and in speed by tests/bench/bench_surfels.cpp. The only place that links PCL's features or
// nanoflann; the program links neither.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace scancast::test {

struct ReferenceSurfel {
    glm::vec3 normal{0};
    float radius = 0;      ///< average distance to the k nearest
    double lineRatio = 0;  ///< λ2/λ1: below 1/16 ours takes more neighbours
    bool tie = false;  ///< the next one is as far as the k-th: which of the two counts is anybody's choice
};

struct ReferenceSurfels {
    std::vector<ReferenceSurfel> surfels;
    /// Of the library's own work: its tree, its queries, its normals. By the clock and of all processors.
    double seconds = 0, processor = 0;
};

/// pcl::NormalEstimationOMP over pcl::search::KdTree, k neighbours and the point itself. Points are distinct.
/// Radii come from the same tree, and are not timed: PCL's estimation does not yield them.
ReferenceSurfels surfelsByPcl(std::span<const glm::vec3> points, int k, int threads);

/// An estimation that is ready to be measured: the points are in PCL's own form already.
struct PclTrial {
    std::function<void()> run;                        ///< once
    std::function<std::vector<glm::vec4>()> results;  ///< normal, sign by PCL's rule; radius, 0 without
};

/// pcl::NormalEstimationOMP, which yields no radii.
PclTrial normalsByPcl(std::span<const glm::vec3> points, int k, int threads);

/// What one would write with PCL who wants radii, too: one query a point for both, oneTBB's threads.
PclTrial normalsAndRadiiByPcl(std::span<const glm::vec3> points, int k, int threads);

/// nanoflann's tree, queried in the points' order, and Eigen's eigenvectors; radii included.
ReferenceSurfels surfelsByNanoflann(std::span<const glm::vec3> points, int k, int threads);

}  // namespace scancast::test
