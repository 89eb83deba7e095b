#include "simulator/surface_net.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace scancast {
namespace {

constexpr int block = 8;  ///< cells along the edge of what is tested, and skipped, at once
constexpr std::uint32_t none = 0xffffffff;

struct Lattice {
    glm::vec3 low;
    float cell;
    glm::ivec3 corners;
    std::vector<float> value;  ///< at the corners

    std::size_t index(int x, int y, int z) const {
        return (std::size_t(z) * std::size_t(corners.y) + std::size_t(y)) * std::size_t(corners.x) +
               std::size_t(x);
    }
    glm::vec3 at(int x, int y, int z) const { return low + glm::vec3(float(x), float(y), float(z)) * cell; }
};

/// The values near the surface; far from it only their sign is right.
void fill(Lattice& lattice, const SignedDistance& distance, float trust) {
    const int blocksZ = (lattice.corners.z + block - 1) / block;
    tbb::parallel_for(0, blocksZ, [&](int bz) {
        for (int y0 = 0; y0 < lattice.corners.y; y0 += block) {
            for (int x0 = 0; x0 < lattice.corners.x; x0 += block) {
                const glm::vec3 middle = lattice.at(x0, y0, bz * block) + glm::vec3(block * lattice.cell / 2);
                const float there = distance(middle);
                // One cell more than the block: its neighbours must know the sign as well.
                const bool far = std::abs(there) * trust > (block + 2) * lattice.cell * 0.8661F;
                for (int z = bz * block; z < std::min((bz + 1) * block, lattice.corners.z); ++z)
                    for (int y = y0; y < std::min(y0 + block, lattice.corners.y); ++y)
                        for (int x = x0; x < std::min(x0 + block, lattice.corners.x); ++x)
                            lattice.value[lattice.index(x, y, z)] =
                                far ? there : distance(lattice.at(x, y, z));
            }
        }
    });
}

/// The middle of the places where the cell's edges cross the surface.
bool crossing(const Lattice& lattice, int x, int y, int z, glm::vec3& middle) {
    std::array<float, 8> value;
    int inside = 0;
    for (int i = 0; i < 8; ++i) {
        value[std::size_t(i)] = lattice.value[lattice.index(x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2))];
        inside += value[std::size_t(i)] < 0;
    }
    if (inside == 0 || inside == 8) return false;
    glm::vec3 sum(0);
    int count = 0;
    for (int i = 0; i < 8; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const int k = i | (1 << axis);
            if (k == i) continue;
            const float a = value[std::size_t(i)], b = value[std::size_t(k)];
            if ((a < 0) == (b < 0)) continue;
            glm::vec3 place(float(i & 1), float((i >> 1) & 1), float(i >> 2));
            place[axis] = a / (a - b);
            sum += place;
            ++count;
        }
    }
    middle = lattice.at(x, y, z) + sum * (lattice.cell / float(count));
    return true;
}

}  // namespace

glm::vec3 outwardNormal(const SignedDistance& distance, const glm::vec3& at) {
    constexpr float step = 1e-3F;
    glm::vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 off(0);
        off[axis] = step;
        gradient[axis] = distance(at + off) - distance(at - off);
    }
    const float length = glm::length(gradient);
    return length > 0 ? gradient / length : glm::vec3(0, 0, 1);
}

SurfaceMesh surfaceNet(const SignedDistance& distance, const glm::vec3& low, const glm::vec3& high,
                       float cell, float trust) {
    Lattice lattice{low, cell, glm::ivec3(0), {}};
    for (int axis = 0; axis < 3; ++axis)
        lattice.corners[axis] = std::max(2, int(std::ceil((high[axis] - low[axis]) / cell)) + 1);
    const glm::ivec3 corners = lattice.corners;
    lattice.value.resize(lattice.index(0, 0, corners.z));
    fill(lattice, distance, trust);

    SurfaceMesh mesh;
    std::vector<std::uint32_t> vertexOf(lattice.value.size(), none);
    for (int z = 0; z + 1 < corners.z; ++z)
        for (int y = 0; y + 1 < corners.y; ++y)
            for (int x = 0; x + 1 < corners.x; ++x) {
                glm::vec3 middle;
                if (!crossing(lattice, x, y, z, middle)) continue;
                vertexOf[lattice.index(x, y, z)] = std::uint32_t(mesh.position.size());
                mesh.position.push_back(middle);
            }
    mesh.normal.resize(mesh.position.size());
    tbb::parallel_for(std::size_t(0), mesh.position.size(), [&](std::size_t i) {
        glm::vec3 at = mesh.position[i];
        glm::vec3 normal = outwardNormal(distance, at);
        // Two steps onto the surface, none farther than half a cell, so that the mesh stays one.
        for (int step = 0; step < 2; ++step) at -= normal * std::clamp(distance(at), -cell / 2, cell / 2);
        mesh.position[i] = at;
        mesh.normal[i] = outwardNormal(distance, at);
    });

    // Every edge that crosses the surface is surrounded by four cells: two triangles.
    const auto quad = [&](std::array<std::uint32_t, 4> v, bool flip) {
        if (flip) std::swap(v[1], v[3]);
        const auto length2 = [&](int a, int b) {
            const glm::vec3 d = mesh.position[v[std::size_t(a)]] - mesh.position[v[std::size_t(b)]];
            return glm::dot(d, d);
        };
        if (length2(0, 2) <= length2(1, 3)) {
            mesh.triangles.push_back({v[0], v[1], v[2]});
            mesh.triangles.push_back({v[0], v[2], v[3]});
        } else {
            mesh.triangles.push_back({v[0], v[1], v[3]});
            mesh.triangles.push_back({v[1], v[2], v[3]});
        }
    };
    for (int z = 1; z + 1 < corners.z; ++z)
        for (int y = 1; y + 1 < corners.y; ++y)
            for (int x = 1; x + 1 < corners.x; ++x) {
                const bool inside = lattice.value[lattice.index(x, y, z)] < 0;
                const std::array<glm::ivec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const glm::ivec3 next = glm::ivec3(x, y, z) + axes[axis];
                    if (inside == (lattice.value[lattice.index(next.x, next.y, next.z)] < 0)) continue;
                    const glm::ivec3 u = axes[(axis + 1) % 3], v = axes[(axis + 2) % 3];
                    const auto vertex = [&](const glm::ivec3& back) {
                        return vertexOf[lattice.index(x - back.x, y - back.y, z - back.z)];
                    };
                    quad({vertex(u + v), vertex(v), vertex(glm::ivec3(0)), vertex(u)}, !inside);
                }
            }
    return mesh;
}

}  // namespace scancast
