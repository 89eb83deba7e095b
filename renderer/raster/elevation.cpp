#include "renderer/raster/elevation.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "renderer/measure/leaf_points.hpp"

namespace scancast {
namespace {

/// What is known of a cell: one number, and how many points it comes from.
struct CellSum {
    double height = 0;  ///< highest, lowest or sum; relative to the cloud's origin
    std::uint32_t count = 0;
};
static_assert(sizeof(CellSum) + sizeof(float) <= bytesPerElevationCell);

class ElevationBlock {
  public:
    ElevationBlock(const Cloud& cloud, const RasterGrid& grid, const CellWindow& window, CellValue value)
        : grid_(grid),
          window_(window),
          value_(value),
          base_(cloud.origin.z),
          cells_(std::size_t(window.cells())) {}

    MeasuredBox box() const {
        // A step more than the cells: which one a point belongs to is for add() to say.
        const double all = std::numeric_limits<double>::max();
        MeasuredBox box;
        box.low = {grid_.left + double(window_.column - 1) * grid_.cell,
                   grid_.top - double(window_.row + window_.rows + 1) * grid_.cell, -all};
        box.high = {grid_.left + double(window_.column + window_.columns + 1) * grid_.cell,
                    grid_.top - double(window_.row - 1) * grid_.cell, all};
        return box;
    }

    void add(std::span<const glm::dvec3> places) {
        for (const glm::dvec3& place : places) {
            const double column = grid_.columnOf(place.x) - double(window_.column);
            const double row = grid_.rowOf(place.y) - double(window_.row);
            if (!(column >= 0 && row >= 0 && column < double(window_.columns) && row < double(window_.rows)))
                continue;
            CellSum& cell = cells_[std::size_t(row) * std::size_t(window_.columns) + std::size_t(column)];
            const double height = place.z - base_;
            if (value_ == CellValue::Mean)
                cell.height += height;
            else if (cell.count == 0)
                cell.height = height;
            else if (value_ == CellValue::Highest)
                cell.height = std::max(cell.height, height);
            else if (value_ == CellValue::Lowest)
                cell.height = std::min(cell.height, height);
            if (cell.count < std::numeric_limits<std::uint32_t>::max()) ++cell.count;
        }
    }

    /// Of a part of what it covers.
    std::vector<float> values(const CellWindow& part, int fill) const {
        std::vector<float> values;
        values.reserve(std::size_t(part.cells()));
        for (std::int64_t row = part.row; row < part.row + part.rows; ++row)
            for (std::int64_t column = part.column; column < part.column + part.columns; ++column)
                values.push_back(valueAt(column - window_.column, row - window_.row, fill));
        return values;
    }

  private:
    const CellSum& at(std::int64_t column, std::int64_t row) const {
        return cells_[std::size_t(row) * std::size_t(window_.columns) + std::size_t(column)];
    }
    double heightOf(const CellSum& cell) const {
        return value_ == CellValue::Mean ? cell.height / cell.count : cell.height;
    }

    float valueAt(std::int64_t column, std::int64_t row, int fill) const {
        const CellSum& cell = at(column, row);
        if (value_ == CellValue::Count) return std::bit_cast<float>(cell.count);
        if (cell.count > 0) return float(base_ + heightOf(cell));
        if (fill == 0) return noElevation;
        const auto height = filled(column, row, fill);
        return height ? float(base_ + *height) : noElevation;
    }

    std::optional<double> filled(std::int64_t column, std::int64_t row, int fill) const {
        static constexpr std::array<std::array<int, 2>, 8> directions{
            {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
        std::array<bool, 8> found{};
        double sum = 0, weights = 0;
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const auto [right, down] = directions[d];
            const double step = right != 0 && down != 0 ? std::sqrt(2.0) : 1;
            for (int i = 1; double(i) * step <= double(fill); ++i) {
                const std::int64_t x = column + i * right, y = row + i * down;
                if (x < 0 || y < 0 || x >= window_.columns || y >= window_.rows) break;
                const CellSum& cell = at(x, y);
                if (cell.count == 0) continue;
                const double distance = double(i) * step, weight = 1 / (distance * distance);
                sum += weight * heightOf(cell);
                weights += weight;
                found[d] = true;
                break;
            }
        }
        for (std::size_t d = 0; d < 4; ++d)
            if (found[d] && found[d + 4]) return sum / weights;
        return std::nullopt;
    }

    const RasterGrid& grid_;
    const CellWindow window_;
    const CellValue value_;
    const double base_;
    std::vector<CellSum> cells_;
};

}  // namespace

Expected<std::vector<float>> elevationOf(const Cloud& cloud, const SampleFilter& filter,
                                         const RasterGrid& grid, const CellWindow& window,
                                         const ElevationOptions& options, const std::stop_token& stop) {
    const int fill = options.value == CellValue::Count ? 0 : options.fill;
    ElevationBlock block(cloud, grid, grid.grown(window, fill), options.value);
    const auto add = [&](std::span<const glm::dvec3> places) { block.add(places); };
    if (auto ok = forLeafPoints(cloud, filter, block.box(), stop, add, options.threads); !ok)
        return passOn(ok);
    return block.values(window, fill);
}

}  // namespace scancast
