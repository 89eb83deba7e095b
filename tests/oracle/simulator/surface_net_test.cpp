// The mesh of a surface given by its distance: closed, turned outwards, on the surface; and the figure that
// is carved so.
#include "simulator/surface_net.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "simulator/scenes/sculpture.hpp"

namespace scancast {
namespace {

float ballDistance(const glm::vec3& at) {
    return glm::distance(at, glm::vec3(0.1F, -0.2F, 0.3F)) - 1;
}

// |p - c| = 1 is the sphere; a closed surface has every edge twice, once in each direction; 4π is its area
// and the normals are its radii.
TEST(SurfaceNet, OfABallIsAClosedSphere) {
    const SurfaceMesh mesh = surfaceNet(ballDistance, {-1.2F, -1.5F, -1}, {1.3F, 1.1F, 1.6F}, 0.05F, 1);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double area = 0;
    for (const auto& triangle : mesh.triangles) {
        const glm::vec3 a = mesh.position[triangle[0]], b = mesh.position[triangle[1]],
                        c = mesh.position[triangle[2]];
        const glm::vec3 across = glm::cross(b - a, c - a);
        area += 0.5 * glm::length(across);
        EXPECT_GT(glm::dot(across, mesh.normal[triangle[0]]), 0) << "turned inwards";
        for (std::size_t i = 0; i < 3; ++i) ++edges[{triangle[i], triangle[(i + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1);
        ASSERT_EQ(edges.count({edge.second, edge.first}), 1u) << "a hole";
    }
    EXPECT_NEAR(area, 12.566370614, 0.03);
    for (std::size_t i = 0; i < mesh.position.size(); ++i) {
        ASSERT_NEAR(ballDistance(mesh.position[i]), 0, 1e-5);
        ASSERT_LT(glm::distance(mesh.normal[i], mesh.position[i] - glm::vec3(0.1F, -0.2F, 0.3F)), 2e-3F);
    }
    EXPECT_GT(mesh.triangles.size(), 5000u);
}

// Its vertices lie on the surface that its distance describes, within a tenth of the lattice; it is as tall
// as it says, and most of it is lit.
TEST(Sculpture, LiesOnItsOwnSurface) {
    const Sculpture& figure = sculpture();
    ASSERT_GT(figure.mesh.triangles.size(), 100000u);
    std::size_t off = 0;
    float top = 0, sun = 0;
    for (std::size_t i = 0; i < figure.mesh.position.size(); ++i) {
        off += std::abs(sculptureDistance(figure.mesh.position[i])) > 8e-4F;
        top = std::max(top, figure.mesh.position[i].z);
        sun += figure.sunlit[i];
        ASSERT_NEAR(glm::length(figure.mesh.normal[i]), 1, 1e-4);
        ASSERT_TRUE(figure.openness[i] > 0 && figure.openness[i] <= 1);
    }
    EXPECT_LT(off, figure.mesh.position.size() / 50);
    EXPECT_NEAR(top, 1.87F, 0.03F);
    EXPECT_GT(sun, 0.15F * float(figure.mesh.position.size()));
}

}  // namespace
}  // namespace scancast
