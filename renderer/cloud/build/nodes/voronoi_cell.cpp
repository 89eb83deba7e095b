#include "renderer/cloud/build/nodes/voronoi_cell.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace scancast {

VoronoiCell::VoronoiCell(double h) : squaredReach_(2 * h * h) {
    corners_[0] = {{-h, -h}, true};
    corners_[1] = {{h, -h}, true};
    corners_[2] = {{h, h}, true};
    corners_[3] = {{-h, h}, true};
}

void VoronoiCell::cut(const glm::dvec2& neighbour) {
    const double middle = glm::dot(neighbour, neighbour) / 2;
    if (!(middle > 0) || count_ + 2 > int(corners_.size())) return;
    std::array<Corner, 64> kept;
    int n = 0;
    for (int i = 0; i < count_; ++i) {
        const Corner& a = corners_[i];
        const Corner& b = corners_[(i + 1) % count_];
        const double da = glm::dot(a.at, neighbour) - middle, db = glm::dot(b.at, neighbour) - middle;
        if (da <= 0) kept[n++] = a;
        if ((da <= 0) == (db <= 0)) continue;
        const glm::dvec2 crossing = a.at + (b.at - a.at) * (da / (da - db));
        // Leaving: the next edge is the bisector. Entering: it is the rest of this edge.
        kept[n++] = {crossing, da <= 0 ? false : a.square};
    }
    std::copy_n(kept.begin(), n, corners_.begin());
    count_ = n;
    squaredReach_ = 0;
    for (int i = 0; i < n; ++i)
        squaredReach_ = std::max(squaredReach_, glm::dot(corners_[i].at, corners_[i].at));
}

double VoronoiCell::area() const {
    double twice = 0;
    for (int i = 0; i < count_; ++i) {
        const glm::dvec2 &a = corners_[i].at, &b = corners_[(i + 1) % count_].at;
        twice += a.x * b.y - a.y * b.x;
    }
    return twice / 2;
}

bool VoronoiCell::isOpen() const {
    return std::any_of(corners_.begin(), corners_.begin() + count_, [](const Corner& c) { return c.square; });
}

}  // namespace scancast
