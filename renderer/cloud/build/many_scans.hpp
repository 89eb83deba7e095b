// Several scans as one, one after the other. Pipeline: import → **many scans** → staging. Owned and used by
// one thread.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// What is known of one of them once its points are read, and its header does not say.
struct SeenOfScan {
    std::array<glm::dvec3, 2> box{glm::dvec3(std::numeric_limits<double>::infinity()),
                                  glm::dvec3(-std::numeric_limits<double>::infinity())};  ///< of its points
    std::uint16_t highestInfrared = 0;
};

/// For several processes that each read a part of the scans: what was seen can be made that of all, and is judged then.
class ManyScans : public PointSource {
  public:
    /// Of each scan, in their order.
    virtual std::span<SeenOfScan> seen() = 0;
    /// All is read, and seen() holds it. Errors: as manyScans() has them at the end of reading.
    virtual Expected<void> judge() = 0;
};

/// At least one source. Attributes are those that any of them has; columns those of the first (what another
/// lacks is 0). `names` are what messages call them, in their order; without, they are numbered. InvalidArgument when their
/// coordinate reference systems forbid it (merged_crs.hpp); at the end of reading, too, where only then it is known where they lie.
Expected<std::unique_ptr<PointSource>> manyScans(std::vector<std::unique_ptr<PointSource>> sources,
                                                 std::span<const std::string> names = {});
/// The same; somebody else calls judge().
Expected<std::unique_ptr<ManyScans>> manyScansInPart(std::vector<std::unique_ptr<PointSource>> sources,
                                                     std::span<const std::string> names);

}  // namespace scancast
