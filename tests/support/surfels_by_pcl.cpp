#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <cmath>
#include <ctime>

#include "tests/support/surfel_references.hpp"

namespace scancast::test {

namespace {

double lineRatio(const pcl::PointCloud<pcl::PointXYZ>& cloud, std::span<const int> members) {
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

}  // namespace

ReferenceSurfels surfelsByPcl(std::span<const glm::vec3> points, int k, int threads) {
    const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    for (const glm::vec3& p : points) cloud->emplace_back(p.x, p.y, p.z);
    const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);

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
        double sum = 0;
        for (int j = 1; j < used; ++j) sum += std::sqrt(squared[std::size_t(j)]);
        s.radius = used > 1 ? float(sum / (used - 1)) : 0;
        s.tie = n > k + 1 && squared[std::size_t(k)] == squared[std::size_t(k) + 1];
        s.lineRatio = lineRatio(*cloud, std::span(found).first(std::size_t(used)));
    }
    return result;
}

}  // namespace scancast::test
