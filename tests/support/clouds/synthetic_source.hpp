// A PointSource for tests: points made by a function of their number, on a grid like a LAS file's or in
// floating point. Deterministic; the simulator's scenes are richer, but this needs no other room.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>

#include "renderer/cloud/point_batch.hpp"

namespace scancast::test {

struct ScanPoint {
    glm::dvec3 position{0};
    std::array<std::uint8_t, 3> color{255, 255, 255};
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;
    glm::vec3 normal{0};
    std::uint16_t nearInfrared = 0;
};

/// Numbers in [0,1) that depend on a counter alone.
inline double uniform(std::uint64_t counter, std::uint64_t stream = 0) {
    std::uint64_t z =
        counter * 0x9e3779b97f4a7c15ull + stream * 0xd1b54a32d192ed03ull + 0x632be59bd9b4e019ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

class SyntheticSource : public PointSource {
  public:
    using Make = std::function<ScanPoint(std::uint64_t index, std::uint64_t count)>;

    /// Attributes say which columns are delivered; a grid step > 0 rounds positions to it, as LAS does.
    SyntheticSource(std::uint64_t count, Make make, Attributes attributes, double gridStep = 0,
                    glm::dvec3 gridOrigin = glm::dvec3(0))
        : count_(count), make_(std::move(make)) {
        header_.format = "synthetic";
        header_.points = count;
        header_.attributes = attributes;
        header_.gridStep = glm::dvec3(gridStep);
        header_.gridOrigin = gridOrigin;
    }

    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }

    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        for (; next_ < count_ && batch.size() < batchPoints; ++next_) {
            const ScanPoint p = make_(next_, count_);
            batch.position.push_back(onGrid(p.position));
            if (header_.attributes.color) batch.color.push_back(p.color);
            if (header_.attributes.intensity) batch.intensity.push_back(p.intensity);
            if (header_.attributes.classification) batch.classification.push_back(p.classification);
            if (header_.attributes.normal) batch.normal.push_back(p.normal);
            if (header_.attributes.nearInfrared) batch.nearInfrared.push_back(p.nearInfrared);
        }
        return batch.size() > 0;
    }

  private:
    glm::dvec3 onGrid(glm::dvec3 p) const {
        for (int a = 0; a < 3; ++a)
            if (header_.gridStep[a] > 0)
                p[a] = header_.gridOrigin[a] +
                       header_.gridStep[a] *
                           std::nearbyint((p[a] - header_.gridOrigin[a]) / header_.gridStep[a]);
        return p;
    }

    ScanHeader header_;
    std::uint64_t count_, next_ = 0;
    Make make_;
};

/// Rolling ground of 200 × 200, in scan lines.
inline ScanPoint ground(std::uint64_t i, std::uint64_t n) {
    const auto side = std::uint64_t(std::ceil(std::sqrt(double(n))));
    const double x = (double(i % side) + uniform(i, 1)) / double(side) * 200;
    const double y = (double(i / side) + uniform(i, 2)) / double(side) * 200;
    return {.position = {x, y, 5 * std::sin(x * 0.07) * std::cos(y * 0.05) + 0.01 * uniform(i, 3)},
            .color = {std::uint8_t(x), std::uint8_t(y), 128}};
}

/// A ball's surface of radius 10, in random order.
inline ScanPoint ball(std::uint64_t i, std::uint64_t) {
    const double z = 2 * uniform(i, 1) - 1, turn = 6.283185307179586 * uniform(i, 2),
                 r = std::sqrt(1 - z * z);
    const glm::dvec3 n(r * std::cos(turn), r * std::sin(turn), z);
    return {.position = n * 10.0, .color = {std::uint8_t(128 + 100 * z), 100, 50}, .normal = glm::vec3(n)};
}

}  // namespace scancast::test
