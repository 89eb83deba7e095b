// Which colours and intensities the points of a scan have, learnt while they flow by, and what that says of
// the cloud: a value that is the same in all of them tells nothing, and is no attribute. Used by one thread.
// Pipeline: import → **staging** → facts. In any order of the points and on any number of threads the same.
#pragma once

#include <vector>

#include "renderer/cloud/build/value_sketch.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

class ValueRanges {
  public:
    /// Columns that the batch lacks are left alone: scans without colours do not make those of others vary.
    void add(const PointBatch& batch);
    /// Tells the facts, whose points and attributes stand already: intensityRange, where values usually lie, and
    /// what of the attributes is constant. One single point varies in nothing; it keeps what is not 0.
    void settle(CloudFacts& facts) const;
    /// Near infrared of 16 bits keeps its high byte, as colours do; what is never above 255 is of 8.
    int nearInfraredShift() const { return nearInfrared_[1] > 255 ? 8 : 0; }
    /// Points of a scan without near infrared, beside others with it: theirs is 0.
    void addWithoutNearInfrared() { nearInfrared_[0] = 0; }
    /// What was found to be constant and has no place in the facts, one sentence each without an end.
    std::vector<std::string> notes(std::uint64_t points) const;

    /// Those of other points of the same scan.
    void join(const ValueRanges& other);
    /// All that was learnt, to be sent to another process and joined there.
    template <class Visit>
    void forFields(Visit visit) {
        visit(colorLow_);
        visit(colorHigh_);
        visit(intensity_);
        visit(nearInfrared_);
        for (ValueSketch& sketch : position_) sketch.forFields(visit);
        visit(intensities_);
        visit(brightness_);
    }

  private:
    /// The one value of all points that have any; nullopt: they differ, or there are none.
    std::optional<std::uint16_t> constantNearInfrared() const;

    std::array<std::uint8_t, 3> colorLow_{255, 255, 255}, colorHigh_{0, 0, 0};
    std::array<std::uint16_t, 2> intensity_{65535, 0}, nearInfrared_{65535, 0};
    std::array<ValueSketch, 3> position_;
    std::vector<std::uint64_t> intensities_ = std::vector<std::uint64_t>(65536);
    std::array<std::uint64_t, 256> brightness_{};
};

}  // namespace scancast
