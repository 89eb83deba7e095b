#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>

#include "tests/support/clouds/surfel_references.hpp"

namespace scancast::test {

namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;
using Tree = pcl::search::KdTree<pcl::PointXYZ>;

double lineRatio(const Points& cloud, std::span<const int> members) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const int i : members) mean += cloud[std::size_t(i)].getVector3fMap().cast<double>();
    mean /= double(members.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const int i : members) {
        const Eigen::Vector3d d = cloud[std::size_t(i)].getVector3fMap().cast<double>() - mean;
        covariance += d * d.transpose();
    }
    const Eigen::Vector3d values =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues();
    return values[2] > 0 ? values[1] / values[2] : 0;
}

Points::Ptr pclPoints(std::span<const glm::vec3> points) {
    const Points::Ptr cloud(new Points);
    cloud->reserve(points.size());
    for (const glm::vec3& p : points) cloud->emplace_back(p.x, p.y, p.z);
    return cloud;
}

/// The first of those found is the point itself.
float meanDistance(std::span<const float> squared) {
    double sum = 0;
    for (std::size_t j = 1; j < squared.size(); ++j) sum += std::sqrt(squared[j]);
    return squared.size() > 1 ? float(sum / double(squared.size() - 1)) : 0;
}

/// Normals and radii of some of a cloud's points.
void estimate(const Points& cloud, const Tree& tree, int k, std::size_t begin, std::size_t end,
              std::vector<glm::vec4>& out) {
    pcl::Indices found;
    std::vector<float> squared;
    for (std::size_t i = begin; i < end; ++i) {
        tree.nearestKSearch(int(i), k + 1, found, squared);
        Eigen::Vector4f plane;
        float curvature = 0;
        if (!pcl::computePointNormal(cloud, found, plane, curvature)) plane.setZero();
        pcl::flipNormalTowardsViewpoint(cloud[i], 0, 0, 0, plane);
        out[i] = {plane[0], plane[1], plane[2], meanDistance(squared)};
    }
}

}  // namespace

PclTrial normalsByPcl(std::span<const glm::vec3> points, int k, int threads) {
    const auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
    const auto run = [cloud = pclPoints(points), normals, k, threads] {
        pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation{unsigned(threads)};
        estimation.setInputCloud(cloud);
        estimation.setSearchMethod(Tree::Ptr(new Tree));
        estimation.setKSearch(k + 1);
        estimation.compute(*normals);
    };
    const auto results = [normals] {
        std::vector<glm::vec4> all;
        for (const pcl::Normal& n : *normals) all.emplace_back(n.normal_x, n.normal_y, n.normal_z, 0);
        return all;
    };
    return {run, results};
}

PclTrial normalsAndRadiiByPcl(std::span<const glm::vec3> points, int k, int threads) {
    const auto all = std::make_shared<std::vector<glm::vec4>>();
    const auto run = [cloud = pclPoints(points), all, k, threads] {
        Tree tree;
        tree.setInputCloud(cloud);
        all->resize(cloud->size());
        tbb::task_arena(threads).execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(0, cloud->size(), 1024),
                [&](const auto& range) { estimate(*cloud, tree, k, range.begin(), range.end(), *all); });
        });
    };
    return {run, [all] { return *all; }};
}

ReferenceSurfels surfelsByPcl(std::span<const glm::vec3> points, int k, int threads) {
    const Points::Ptr cloud = pclPoints(points);
    const Tree::Ptr tree(new Tree);

    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation{unsigned(threads)};
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(tree);
    estimation.setKSearch(k + 1);
    pcl::PointCloud<pcl::Normal> normals;
    estimation.compute(normals);
    ReferenceSurfels result;
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.processor = double(std::clock() - before) / CLOCKS_PER_SEC;

    result.surfels.resize(points.size());
    pcl::Indices found;
    std::vector<float> squared;
    for (std::size_t i = 0; i < points.size(); ++i) {
        ReferenceSurfel& s = result.surfels[i];
        s.normal = {normals[i].normal_x, normals[i].normal_y, normals[i].normal_z};
        const int n = tree->nearestKSearch(int(i), k + 2, found, squared);
        const int used = std::min(n, k + 1);
        s.radius = meanDistance(std::span(squared).first(std::size_t(used)));
        s.tie = n > k + 1 && squared[std::size_t(k)] == squared[std::size_t(k) + 1];
        s.lineRatio = lineRatio(*cloud, std::span(found).first(std::size_t(used)));
    }
    return result;
}

}  // namespace scancast::test
