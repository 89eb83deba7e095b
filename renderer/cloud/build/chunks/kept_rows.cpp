#include "renderer/cloud/build/chunks/kept_rows.hpp"

#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

namespace scancast {

namespace {

int compare(const BuildPoint& a, const BuildPoint& b) {
    return std::memcmp(&a, &b, sizeof(BuildPoint));
}

}  // namespace

// Buckets of a few points each by their hash: what is alike is found in one of them, wherever it was read.
KeptRows::KeptRows(std::span<const BuildPoint> points, std::span<const std::byte> rows, std::size_t rowBytes)
    : points_(points.begin(), points.end()),
      rows_(rows.begin(), rows.end()),
      rowBytes_(rowBytes),
      bucketBits_(int(std::bit_width(points.size() / 4))),
      first_((std::size_t(1) << bucketBits_) + 1),
      order_(points.size()) {
    static_assert(std::has_unique_object_representations_v<BuildPoint>);
    std::vector<std::uint32_t> bucket(points.size());
    tbb::parallel_for(std::size_t(0), bucket.size(),
                      [&](std::size_t i) { bucket[i] = std::uint32_t(bucketOf(points_[i])); });
    for (const std::uint32_t b : bucket) ++first_[b + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < bucket.size(); ++i) order_[next[bucket[i]]++] = i;
    tbb::parallel_for(std::size_t(0), next.size(), [&](std::size_t b) {
        std::sort(order_.begin() + first_[b], order_.begin() + first_[b + 1],
                  [&](std::uint32_t one, std::uint32_t other) {
                      const int order = compare(points_[one], points_[other]);
                      return order != 0 ? order < 0
                                        : std::memcmp(row(one).data(), row(other).data(), rowBytes_) < 0;
                  });
    });
}

std::size_t KeptRows::bucketOf(const BuildPoint& point) const {
    return bucketBits_ == 0 ? 0 : XXH3_64bits(&point, sizeof point) >> (64 - bucketBits_);
}

std::vector<std::byte> KeptRows::rowsOf(std::span<const BuildPoint> leaf) const {
    std::vector<std::byte> out;
    out.reserve(leaf.size() * rowBytes_);
    auto next = order_.end();
    for (std::size_t i = 0; i < leaf.size(); ++i) {
        if (i == 0 || compare(leaf[i], leaf[i - 1]) != 0) {
            const std::size_t bucket = bucketOf(leaf[i]);
            next = std::lower_bound(
                order_.begin() + first_[bucket], order_.begin() + first_[bucket + 1], leaf[i],
                [&](std::uint32_t a, const BuildPoint& p) { return compare(points_[a], p) < 0; });
        }
        const auto found = row(*next++);
        out.insert(out.end(), found.begin(), found.end());
    }
    return out;
}

}  // namespace scancast
