// What a view means for one cloud, looked up and checked once: method, passes, camera, colours, and how to
// select. The order of a picture carries it, as does everything that is made of that order. Touches neither
// samples nor devices. Pure functions; any thread. Pipeline: view + cloud → **planned view** → prepare →
// draw.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"
#include "renderer/select/select.hpp"
#include "renderer/select/viewpoint.hpp"

namespace scancast {

/// Immutable once it is made.
struct PlannedView {
    View view;
    std::string method;
    std::string reason;  ///< why this method, where the view left that open
    Viewpoint viewpoint;
    PassList passes;
    std::string colorName;  ///< what `color` is made of, as the word says it: "rgb*intensity"
    std::string colormap;   ///< which ramp it takes, where it takes one
    std::optional<std::array<double, 2>> colorRange;  ///< what the ramp's ends stand for (rampEnds())
    double exposure = 0;                              ///< of rgb, stops
    ColorRule color;
    SampleFilter filter;
    /// The cloud's octree as its columns are asked for, which is drawn in the place of the cloud's own; null: its own.
    std::shared_ptr<const Octree> pictured;
    SelectOptions selection;
    std::optional<Viewpoint> sun;  ///< what it sees is the map of shadows; none: nothing is in the shadow
    SelectOptions sunSelection;
    bool curvatures = false;  ///< samples need theirs: for light or for colour
    bool beside = false;      ///< what stands beside samples is needed: curvatures or near infrared
    int margin = 0;           ///< px around a tile that its screen passes look at
    /// None of them looks farther, so a picture has the same bytes in tiles as in one piece.
    bool tilesAreExact = true;
};

/// Errors: those of validate(); NotFound for a method; InvalidArgument for its parameters, colour map, range;
/// Unsupported when the cloud lacks what the style needs.
Expected<std::shared_ptr<const PlannedView>> plan(const Cloud& cloud, const View& view);

/// What can be judged of it before there is a cloud, which may take minutes to read: the method, and its parameters. Errors:
/// plan()'s.
Expected<void> checkMethod(const Style& style);

/// Whether a view can be planned, for who needs nothing but the answer. Errors: those of plan().
Expected<void> checkView(const Cloud& cloud, const View& view);

/// Where a client starts: as the cloud's look says; without one the whole cloud from the south-east.
View defaultView(const Cloud& cloud, int width = 1280, int height = 720);

/// The best views of the cloud, the first one first, fitted to pictures of this width / height; one of a cloud
/// without a look.
std::vector<LookView> viewsOf(const Cloud& cloud, double aspect);

/// What is drawn: the cloud's octree, or what a view's columns made of it.
inline const Octree& octreeOf(const Cloud& cloud, const PlannedView& planned) {
    return planned.pictured ? *planned.pictured : cloud.octree;
}

/// As many samples as a picture may hold on to; nullopt = as many as there are.
std::optional<std::uint64_t> mostSamples(const Octree& octree);
inline std::optional<std::uint64_t> mostSamples(const Cloud& cloud) {
    return mostSamples(cloud.octree);
}

}  // namespace scancast
