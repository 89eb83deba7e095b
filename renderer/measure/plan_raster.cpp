#include "renderer/measure/plan_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

namespace scancast {
namespace {

// Shares are floats: what is nearer to all or nothing is that.
constexpr double nearly = 1e-6;

std::array<glm::dvec2, 2> boundsOfCorners(std::span<const glm::dvec2> corners) {
    glm::dvec2 low = corners.front(), high = low;
    for (const glm::dvec2& corner : corners) low = glm::min(low, corner), high = glm::max(high, corner);
    return {low, high};
}

}  // namespace

glm::dvec2 PlanRaster::sizeOf(std::span<const glm::dvec2> corners, double cell) {
    const auto [low, high] = boundsOfCorners(corners);
    return glm::max(glm::ceil((high - low) / cell - 1e-9), glm::dvec2(1));
}

PlanRaster::PlanRaster(std::vector<glm::dvec2> corners, double cell)
    : corners_(std::move(corners)), cell_(cell) {
    const glm::dvec2 size = sizeOf(corners_, cell);
    low_ = boundsOfCorners(corners_)[0];
    columns_ = std::size_t(size.x);
    rows_ = std::size_t(size.y);
    for (glm::dvec2& corner : corners_) corner -= low_;
    shares_.resize(cells());
    // Each edge adds, to the cells that it goes through and the next, the area that lies to the right of it; running sums along a row are
    // then the areas of the polygon. Rows are done one by one, so that a row's sums are all the memory that it takes.
    std::vector<double> sums(columns_ + 2);
    std::vector<std::array<glm::dvec2, 2>> edges, active;
    for (std::size_t i = 0; i < corners_.size(); ++i)
        edges.push_back({corners_[i] / cell_, corners_[(i + 1) % corners_.size()] / cell_});
    std::erase_if(edges, [](const auto& edge) { return edge[0].y == edge[1].y; });
    std::ranges::sort(edges, std::ranges::greater(),
                      [](const auto& edge) { return std::min(edge[0].y, edge[1].y); });
    for (std::size_t row = 0; row < rows_; ++row) {
        std::ranges::fill(sums, 0.0);
        const double bottom = double(row), top = bottom + 1;
        for (; !edges.empty() && std::min(edges.back()[0].y, edges.back()[1].y) < top; edges.pop_back())
            active.push_back(edges.back());
        std::erase_if(active, [&](const auto& edge) { return std::max(edge[0].y, edge[1].y) <= bottom; });
        for (const auto& [a, b] : active) {
            const auto at = [&, from = a, to = b](double y) {
                return glm::dvec2(from.x + (to.x - from.x) * ((y - from.y) / (to.y - from.y)), y);
            };
            const glm::dvec2 first = a.y < bottom ? at(bottom) : a.y > top ? at(top) : a;
            const glm::dvec2 last = b.y < bottom ? at(bottom) : b.y > top ? at(top) : b;
            addEdge(sums, first, last);
        }
        double sum = 0;
        for (std::size_t column = 0; column < columns_; ++column) {
            sum += sums[column];
            const double share = std::abs(sum);
            shares_[row * columns_ + column] = float(share < nearly ? 0 : share > 1 - nearly ? 1 : share);
        }
    }
}

/// An edge within one row, in cells.
void PlanRaster::addEdge(std::vector<double>& sums, glm::dvec2 from, glm::dvec2 to) const {
    const double most = double(columns_);
    from.x = std::clamp(from.x, 0.0, most);
    to.x = std::clamp(to.x, 0.0, most);
    const double height = to.y - from.y;  // with its sign
    const double left = std::min(from.x, to.x), right = std::max(from.x, to.x);
    const auto firstCell = std::size_t(left);
    const std::size_t lastCell = std::min(std::size_t(right), columns_);
    if (firstCell >= lastCell) {
        const double middle = (left + right) / 2 - double(firstCell);
        sums[firstCell] += height * (1 - middle);
        sums[firstCell + 1] += height * middle;
        return;
    }
    for (std::size_t cell = firstCell; cell <= lastCell; ++cell) {
        const double a = std::max(left, double(cell)), b = std::min(right, double(cell + 1));
        if (b <= a) continue;
        const double part = height * (b - a) / (right - left), middle = (a + b) / 2 - double(cell);
        sums[cell] += part * (1 - middle);
        sums[cell + 1] += part * middle;
    }
}

bool PlanRaster::isInside(const glm::dvec2& point) const {
    bool inside = false;
    for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
        const glm::dvec2 &a = corners_[i], &b = corners_[j];
        if ((a.y > point.y) != (b.y > point.y) &&
            point.x < (b.x - a.x) * ((point.y - a.y) / (b.y - a.y)) + a.x)
            inside = !inside;
    }
    return inside;
}

std::optional<std::size_t> PlanRaster::cellOf(const glm::dvec2& point) const {
    const glm::dvec2 from = point - low_;
    if (!(from.x >= 0 && from.y >= 0)) return std::nullopt;
    // What lies on the far edge belongs to the last cell.
    const double x = std::floor(from.x / cell_), y = std::floor(from.y / cell_);
    if (x > double(columns_) || y > double(rows_)) return std::nullopt;
    const std::size_t cell =
        std::min(std::size_t(y), rows_ - 1) * columns_ + std::min(std::size_t(x), columns_ - 1);
    if (shares_[cell] <= 0) return std::nullopt;
    if (shares_[cell] >= 1 || isInside(from)) return cell;
    return std::nullopt;
}

}  // namespace scancast
