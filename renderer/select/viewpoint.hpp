// A camera made ready for one cloud and one picture size: the numbers that selection and devices compute
// with. Pipeline: view → **viewpoint** → select, device. A pure value.
//
// Frame of reference (docs/spec/passes.md §1): cloud-relative coordinates → view space, right-handed, looking
// down -z; depth d = -z_view > 0; picture row 0 is the top; pixel centres at +0.5.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "protocol/view/view.hpp"

namespace scancast {

struct Viewpoint {
    int width = 0, height = 0;             ///< of the whole picture, px
    Projection projection = Projection::Perspective;
    glm::dmat4 cloudToView{1};             ///< rigid; cloud-relative → view space
    double pixelsPerUnit = 1;              ///< perspective: focal length f in px (q = f/d); orthographic: q itself
    double near = 0, far = 0;              ///< depths; far may be infinity

    /// q(d), px per cloud unit at depth d.
    double q(double depth) const {
        return projection == Projection::Perspective ? pixelsPerUnit / depth : pixelsPerUnit;
    }
    /// View space → picture, px, y down. z is the depth d; only meaningful for d ≥ near.
    glm::dvec3 project(const glm::dvec3& viewSpace) const;
    /// The eye, cloud-relative (orthographic: a point on the near plane's axis).
    glm::dvec3 eye() const;
    /// Unit view direction, cloud-relative.
    glm::dvec3 direction() const;
    /// Left, right, bottom, top, near, far in cloud-relative coordinates: inside where dot(xyz, p) + w ≥ 0; unit
    /// normals. `far` is (0,0,0,1) when infinite.
    std::array<glm::dvec4, 6> frustum() const;

    /// `origin` and `bounds` are the cloud's (file coordinates); automatic near and far come from them.
    /// Expects a view that passed validate(); fails as that does.
    static Expected<Viewpoint> create(const View& view, const glm::dvec3& origin,
                                      const std::array<glm::dvec3, 2>& bounds);
};

}  // namespace scancast
