// From a pixel back to the scan: the point of the cloud that a pixel of a picture shows.
// Pipeline: depth of the picture → **pick** → file coordinates. Pure functions; any thread, which may wait
// for blocks.
//
// The picture's depth says where the surface under the pixel lies, whatever method drew it, so that only what
// is visible can be picked. The nearest of the scan's own points (leaf samples: inner ones are averages) to
// that place is the answer; what the view does not draw - other classes, outside the clip box, what shapes cut away, behind
// mirrors - is none.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/kept_point.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

struct Picked {
    /// The scan's own point, with all that is kept of it. Where its coordinates are rounded (not `exact`), without digits that say
    /// nothing.
    KeptPoint point;
    /// The place of the surface under the pixel's middle, file coordinates: no point of the scan, but nearer to what was pointed at than
    /// the nearest one. Where the pixel's ray meets the plane through the point that its normal says; where that is none, or far from what the
    /// picture's depth says, what that says.
    glm::dvec3 surface{0};
    Sample sample{};      ///< its attributes
    double radius = 0;    ///< of its surfel, cloud units; 0 = it has none
    double depth = 0;     ///< of the surface under the pixel, cloud units
    double distance = 0;  ///< from there to the point, cloud units
    /// Of several clouds together, whose point it is: what is said of it is as that cloud has it, unmoved and untinted.
    struct Of {
        std::shared_ptr<const Cloud> cloud;
        std::string name;     ///< as the view calls it
        glm::dvec3 shift{0};  ///< by which it is seen elsewhere
    };
    std::optional<Of> of{};
};

/// Cloud-relative place of a pixel's centre at that depth. Errors: those of Viewpoint::create().
Expected<glm::dvec3> placeUnder(const Cloud& cloud, const View& view, const glm::ivec2& pixel, double depth);

/// Whether a sample may be drawn: the view's classes, its clip, nothing behind mirrors. `p`: cloud-relative.
bool isDrawn(const SampleFilter& filter, const glm::dvec3& p, const Sample& sample);

/// nullopt for background (depth +infinity), for the glass of a mirror that the view shows, and where every
/// point is filtered out. Of equally near points the first. Errors: those of placeUnder(), of the cloud's
/// blocks and of what stands beside them (CloudFile::point()); Cancelled.
Expected<std::optional<Picked>> pick(const Cloud& cloud, const View& view, const glm::ivec2& pixel,
                                     double depth, std::stop_token stop = {});

}  // namespace scancast
