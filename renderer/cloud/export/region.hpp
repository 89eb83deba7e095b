// The part of a scan that is wanted, made ready to be asked of many nodes and points. Pipeline: points → **region** → writer.
// Tests are immutable, and read from any thread; a source is owned and used by one.
#pragma once

#include <memory>
#include <optional>

#include "protocol/points/points_region.hpp"
#include "renderer/cloud/export/plan_polygon.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class RegionTest {
  public:
    /// A region that has been checked (points_region.hpp).
    explicit RegionTest(PointsRegion region);

    const PointsRegion& region() const { return region_; }
    bool hasClasses() const { return region_.classes.has_value(); }
    bool takes(std::uint8_t itsClass) const { return !region_.classes || region_.classes->test(itsClass); }
    /// Whether a point in this place is in it, whatever its class. File coordinates.
    bool contains(const glm::dvec3& p) const;
    /// Of all that may be in a box, whatever its class. Inside and Outside hold for every place of it.
    Within of(const glm::dvec3& low, const glm::dvec3& high) const;

  private:
    PointsRegion region_;
    std::optional<PolygonTest> polygon_;
    ClipRegions clips_;
    glm::dvec3 clipsOrigin_{0};  ///< that clips_ count from: near what they cut
};

/// Takes out what is not in the region, of a batch with rows of so many bytes.
void keepWithin(const RegionTest& region, std::size_t rowBytes, PointBatch& batch);

/// `source` itself for everything. Else nobody knows how many points there will be, and where.
std::unique_ptr<PointSource> within(const PointsRegion& region, std::unique_ptr<PointSource> source);

}  // namespace scancast
