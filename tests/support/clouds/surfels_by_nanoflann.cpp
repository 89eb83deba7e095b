#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <cmath>
#include <ctime>
#include <nanoflann.hpp>

#include "tests/support/clouds/surfel_references.hpp"

namespace scancast::test {

namespace {

/// What nanoflann asks of a set of points.
struct Points {
    std::span<const glm::vec3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][int(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3,
                                                 std::uint32_t>;

ReferenceSurfel surfel(const Tree& tree, std::span<const glm::vec3> points, std::size_t at, int k) {
    std::vector<std::uint32_t> found(std::size_t(k) + 2);
    std::vector<float> squared(found.size());
    const std::size_t n = tree.knnSearch(&points[at].x, found.size(), found.data(), squared.data());
    const std::size_t used = std::min(n, std::size_t(k) + 1);
    ReferenceSurfel s;
    s.tie = n > used && squared[used - 1] == squared[used];
    double sum = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t j = 0; j < used; ++j) {
        const glm::vec3 d = points[found[j]] - points[at];
        const Eigen::Vector3d offset(d.x, d.y, d.z);
        mean += offset;
        covariance += offset * offset.transpose();
        sum += std::sqrt(squared[j]);
    }
    s.radius = used > 1 ? float(sum / double(used - 1)) : 0;
    mean /= double(used);
    covariance = covariance / double(used) - mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(covariance);
    const Eigen::Vector3d normal = solver.eigenvectors().col(0);
    s.normal = {normal[0], normal[1], normal[2]};
    s.lineRatio = solver.eigenvalues()[2] > 0 ? solver.eigenvalues()[1] / solver.eigenvalues()[2] : 0;
    return s;
}

}  // namespace

ReferenceSurfels surfelsByNanoflann(std::span<const glm::vec3> points, int k, int threads) {
    ReferenceSurfels result;
    result.surfels.resize(points.size());
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    const Points set{points};
    const Tree tree(3, set, {10});
    tbb::task_arena(threads).execute([&] {
        tbb::parallel_for(std::size_t(0), points.size(),
                          [&](std::size_t i) { result.surfels[i] = surfel(tree, points, i, k); });
    });
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.processor = double(std::clock() - before) / CLOCKS_PER_SEC;
    return result;
}

}  // namespace scancast::test
