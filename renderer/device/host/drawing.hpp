// From a drawing to what devices draw of it: its passes in their places, its pixels with all that passes look at
// around them, and how its layers are seen. Pure functions; any thread. Pipeline: passes → **drawing** → device.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "renderer/device/device.hpp"

namespace scancast {

/// Frames that can be averaged into one picture: their sums have 16 bits a channel.
inline constexpr std::size_t mostFrames = 256;

/// InvalidArgument for a window outside the picture, ResourceLimit for more frames than can be averaged.
Expected<void> checkDrawing(const Drawing& drawing);

/// Hidden point removal finds 19 % of the hidden points near a border without it (docs/spec/pyramid.md §2).
inline constexpr int pyramidGuardBand = 32;

/// A method's list of passes, each in its place: what is splatted, and what is done to the whole picture afterwards.
struct FramePasses {
    std::optional<SilhouettePass> silhouette;
    NearestPass nearest;
    std::optional<CellPass> cell;
    std::optional<SumPass> sum;
    ResolvePass resolve;
    PassList screen;

    /// Colours come from samples looked up by their ordinals.
    bool bySample() const {
        return cell ? !resolve.sums : !bySurface() && nearest.payload == Payload::Sample;
    }
    /// A later pass looks at what is visible: the nearest's keys carry surfaces, and its colours are that pass's.
    bool bySurface() const { return cell || (sum && resolve.sums && (sum->normals || ofSurfels(*sum))); }
    /// There is a ShadowPass.
    bool castsShadows() const;
    /// Normals are needed by a later pass.
    bool normals() const { return resolve.normals || makesNormals(); }
    /// Pixels around the window that screen passes and smoothed borders look at, as far as there is a picture …
    int reach() const;
    /// … and those that are drawn beyond its border, for passes that judge a pixel by what surrounds it.
    int guardBand() const;

  private:
    bool makesNormals() const;
};

/// What the sun sees: the depths of the surface that is nearest to it. Colours mean nothing.
FramePasses shadowMapPasses(bool surfels);

/// Unsupported for a list that pass.hpp does not describe, with the reason.
Expected<FramePasses> framePasses(std::span<const Pass> passes);

/// How a layer - the main view or a reflection - is seen.
struct LayerView {
    const Viewpoint* viewpoint = nullptr;
    int pad = 0;                 ///< rows and columns that every coordinate is shifted by, for a guard band
    bool surfels = false;        ///< samples carry radii, ellipses and normals
    bool oriented = false;       ///< every normal's sign means something
    bool orientedNodes = false;  ///< those of nodes that are sure of it do
    bool curvatures = false;     ///< samples know theirs
    /// The view axis, px, before jitter.
    glm::dvec2 center() const { return {viewpoint->width * 0.5 + pad, viewpoint->height * 0.5 + pad}; }
    bool anyOriented() const { return oriented || orientedNodes; }
    bool perspective() const { return viewpoint->projection == Projection::Perspective; }
};

struct PictureArea {
    LayerView view;  ///< the main one
    /// Of the picture with its guard band, if there is one: by so much every coordinate is shifted, because
    /// devices know no negative pixels.
    Window window;
    Window area;  ///< the window, and what screen passes look at beyond it
};

PictureArea pictureArea(const Drawing& drawing, const FramePasses& passes);

/// What a frame's statistics say of its cuts, all of them together.
void tellCuts(std::span<const CutView> cuts, FrameStats& stats);

}  // namespace scancast
