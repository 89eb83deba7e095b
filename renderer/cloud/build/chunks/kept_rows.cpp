#include "renderer/cloud/build/chunks/kept_rows.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstring>
#include <numeric>

namespace scancast {

namespace {

int compare(const BuildPoint& a, const BuildPoint& b) {
    return std::memcmp(&a, &b, sizeof(BuildPoint));
}

}  // namespace

KeptRows::KeptRows(std::span<const BuildPoint> points, std::span<const std::byte> rows, std::size_t rowBytes)
    : points_(points.begin(), points.end()),
      rows_(rows.begin(), rows.end()),
      rowBytes_(rowBytes),
      order_(points.size()) {
    static_assert(std::has_unique_object_representations_v<BuildPoint>);
    std::iota(order_.begin(), order_.end(), 0u);
    tbb::parallel_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        const int order = compare(points_[a], points_[b]);
        return order != 0 ? order < 0 : std::memcmp(row(a).data(), row(b).data(), rowBytes_) < 0;
    });
}

std::vector<std::byte> KeptRows::rowsOf(std::span<const BuildPoint> leaf) const {
    std::vector<std::byte> out;
    out.reserve(leaf.size() * rowBytes_);
    auto next = order_.end();
    for (std::size_t i = 0; i < leaf.size(); ++i) {
        if (i == 0 || compare(leaf[i], leaf[i - 1]) != 0)
            next = std::lower_bound(
                order_.begin(), order_.end(), leaf[i],
                [&](std::uint32_t a, const BuildPoint& p) { return compare(points_[a], p) < 0; });
        const auto found = row(*next++);
        out.insert(out.end(), found.begin(), found.end());
    }
    return out;
}

}  // namespace scancast
