#include "renderer/cloud/build/value_sketch.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {

namespace {

/// Keys stay exact in a double, too.
constexpr double largestKey = 0x1p52;

std::size_t placeOf(std::int64_t key) {
    return std::size_t(std::uint64_t(key) * 0x9e3779b97f4a7c15u >> 51);  // 13 bits: 8192 places
}

}  // namespace

std::size_t ValueSketch::find(std::int64_t key) const {
    std::size_t at = placeOf(key);
    while (table_[at].count > 0 && table_[at].key != key) at = (at + 1) % places;
    return at;
}

void ValueSketch::widen() {
    ++exponent_;
    scale_ = std::ldexp(1.0, -exponent_);
    if (used_ == 0) return;
    std::vector<Cell> old(places);
    old.swap(table_);
    used_ = 0;
    for (const Cell& cell : old) {
        if (cell.count == 0) continue;
        Cell& to = table_[find(cell.key >> 1)];
        if (to.count == 0) ++used_;
        to.key = cell.key >> 1;
        to.count += cell.count;
    }
}

void ValueSketch::add(double value) {
    if (!std::isfinite(value)) return;
    while (std::abs(value) * scale_ >= largestKey) widen();
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
    ++count_;
    const auto key = std::int64_t(std::floor(value * scale_));
    addCell(key, 1);
}

void ValueSketch::addCell(std::int64_t key, std::uint64_t count) {
    if (table_[last_].count == 0 || table_[last_].key != key) last_ = find(key);
    Cell& cell = table_[last_];
    if (cell.count == 0) ++used_;
    cell.count += count;
    cell.key = key;
    while (used_ > mostCells) widen();
}

void ValueSketch::join(const ValueSketch& other) {
    while (exponent_ < other.exponent_) widen();
    low_ = std::min(low_, other.low_);
    high_ = std::max(high_, other.high_);
    count_ += other.count_;
    // While these are added, cells may widen further: keys follow them.
    for (const Cell& cell : other.table_)
        if (cell.count > 0) addCell(cell.key >> std::min(exponent_ - other.exponent_, 63), cell.count);
}

ValueHistogram ValueSketch::histogram(const HistogramParts& parts) const {
    ValueHistogram histogram = parts.empty();
    // A whole number stands where its cell begins, if cells are that narrow; of other values the middle is nearest.
    const double within = parts.whole && exponent_ <= 0 ? 0 : 0.5;
    for (const Cell& cell : table_)
        if (cell.count > 0)
            addTo(histogram, std::clamp((double(cell.key) + within) / scale_, low_, high_), cell.count);
    return histogram;
}

double ValueSketch::quantile(double q) const {
    if (count_ == 0) return 0;
    std::vector<Cell> cells;
    for (const Cell& cell : table_)
        if (cell.count > 0) cells.push_back(cell);
    std::ranges::sort(cells, {}, &Cell::key);
    const double rank = q * double(count_);
    double below = 0;
    for (const Cell& cell : cells) {
        if (below + double(cell.count) >= rank) {
            const double within = (rank - below) / double(cell.count);
            return std::clamp((double(cell.key) + within) / scale_, low_, high_);
        }
        below += double(cell.count);
    }
    return high_;
}

}  // namespace scancast
