// What is told of a column of distances: its facts, and those of the cloud that has it. Pipeline: distances → **column** → facts.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "renderer/cloud/build/value_sketch.hpp"
#include "renderer/cloud/distance/epoch_distance.hpp"

namespace scancast {

/// All distances of a column, while they flow by. In any order the same. Used by one thread.
class DistanceSummary {
  public:
    explicit DistanceSummary(double most) : most_(float(most)) {}

    void add(std::span<const float> distances);
    std::uint64_t beyond() const { return beyond_; }
    double median() const { return sketch_.quantile(0.5); }
    /// Range, where values usually lie, and their histogram.
    void tell(KeptColumn& column) const;

  private:
    float most_;
    std::uint64_t beyond_ = 0;
    std::array<double, 2> range_{std::numeric_limits<double>::infinity(),
                                 -std::numeric_limits<double>::infinity()};
    ValueSketch sketch_;
};

/// Name, type and description, which says to what, in which unit and up to where it was measured.
Column distanceColumn(const DistanceOptions& options, const CloudFacts& before, const std::string& unit);

}  // namespace scancast
