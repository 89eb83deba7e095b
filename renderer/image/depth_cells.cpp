#include "renderer/image/depth_cells.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace scancast {
namespace {

/// Of one cell, in pixels.
struct Area {
    int left, right, top, bottom;
};

/// Whether a pixel shows a surface; what lies at or behind the eye is none.
bool isCovered(float depth) {
    return std::isfinite(depth) && depth > 0;
}

float nearestToMiddle(const Frame& frame, const Area& area) {
    const float* const depth = frame.depth.data();
    const auto at = [&](int x, int y) {
        return depth[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)];
    };
    // Twice the middle, so that it is a whole number; the first of the pixels around it is the usual answer.
    const int middleX = area.left + area.right - 1, middleY = area.top + area.bottom - 1;
    float found = at(middleX / 2, middleY / 2);
    if (isCovered(found)) return found;
    found = std::numeric_limits<float>::infinity();
    int least = std::numeric_limits<int>::max();
    for (int y = area.top; y < area.bottom; ++y) {
        const int dy = 2 * y - middleY;
        for (int x = area.left; x < area.right; ++x) {
            const int dx = 2 * x - middleX;
            const float there = at(x, y);
            if (!isCovered(there) || dx * dx + dy * dy >= least) continue;
            least = dx * dx + dy * dy;
            found = there;
        }
    }
    return found;
}

int cellsAlong(int side, int longer) {
    const int cells = std::min(longer, mostDepthCells);
    return std::min(side, std::max(2, (side * cells + longer / 2) / longer));
}

}  // namespace

std::array<int, 2> depthCellsOf(int width, int height) {
    const int longer = std::max(width, height);
    return {cellsAlong(width, longer), cellsAlong(height, longer)};
}

DepthCells depthCells(const Frame& frame) {
    assert(frame.depth.size() == std::size_t(frame.width) * std::size_t(frame.height));
    DepthCells cells;
    const auto [width, height] = depthCellsOf(frame.width, frame.height);
    cells.width = width;
    cells.height = height;
    cells.depth.reserve(std::size_t(width) * std::size_t(height));
    for (int j = 0; j < height; ++j) {
        const int top = j * frame.height / height, bottom = (j + 1) * frame.height / height;
        for (int i = 0; i < width; ++i)
            cells.depth.push_back(nearestToMiddle(
                frame, {i * frame.width / width, (i + 1) * frame.width / width, top, bottom}));
    }
    return cells;
}

}  // namespace scancast
