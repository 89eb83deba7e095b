#include "renderer/method/pyramid.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/method/parameters.hpp"

namespace scancast {
namespace {

/// Points less than this many times the noise in front of others are the same surface.
constexpr double gapInNoises = 3;

/// The least width of a surface that is looked at for its slope, in spacings; and that by which the noise's error of a
/// normal, which falls with the square of the width, comes to three degrees at most. One degree would take twice the width,
/// and faces with it: what is measured as noise is fine relief, too.
constexpr double narrowestSlope = 2, slopePerRootOfNoise = 3.8;

/// Cloud units.
double noiseOf(const PassRequest& request) {
    const double given = numberOf(request.values, "noise");
    return given > 0 ? given : request.cloud.noise;
}

/// Cloud units: what is less in front of a point does not hide it.
double minGapOf(const PassRequest& request) {
    const double given = numberOf(request.values, "minGap");
    return given >= 0 ? given : gapInNoises * noiseOf(request);
}

/// Where levels of detail have thinned a noisy scan out, points are far apart for their noise, and nothing is widened: so
/// it is the spacing that grows, not the scale.
DepthNormalsPass normalsOf(const PassRequest& request, double spacing) {
    const double given = numberOf(request.values, "normalScale");
    const double wide = spacing > 0 ? slopePerRootOfNoise * std::sqrt(noiseOf(request) / spacing) : 0;
    DepthNormalsPass normals;
    normals.scale = static_cast<float>(given > 0 ? given : narrowestSlope);
    normals.spacing =
        static_cast<float>(given > 0 ? spacing : spacing * std::max(1.0, wide / narrowestSlope));
    normals.detail = static_cast<float>(request.detail);
    return normals;
}

PassList pyramidPasses(const PassRequest& request) {
    const ParameterValues& values = request.values;
    const double given = numberOf(values, "spacing");
    const double spacing = given > 0 ? given : request.cloud.spacing;

    NearestPass nearest;
    nearest.footprint = Footprint::Pixel;
    nearest.profile = Profile::Flat;
    nearest.size.sizePx = 1;
    nearest.gain = 0;

    HiddenPointsPass hidden;
    hidden.scale = static_cast<float>(numberOf(values, "hprScale"));
    hidden.fixedPx = static_cast<float>(numberOf(values, "hprPx"));
    hidden.spacing = static_cast<float>(spacing);
    hidden.detail = static_cast<float>(request.detail);
    hidden.minGap = static_cast<float>(minGapOf(request));
    hidden.threshold = static_cast<float>(numberOf(values, "threshold"));

    if (request.visibility) return {nearest, ResolvePass{}, hidden, VisibilityPass{}};
    PassList list{nearest, ResolvePass{}, hidden, PullPushPass{}};
    if (request.shading == Shading::Phong) list.push_back(normalsOf(request, spacing));
    addShading(request, list);
    return list;
}

std::vector<Parameter> parameters() {
    return {
        numberParameter("hprScale", 5, 3, 20, "",
                        "How far points look for others that hide them, in point spacings; more removes "
                        "sparser surfaces' background and closes larger windows."),
        numberParameter("hprPx", 0, 0, 4096, "px",
                        "The same in pixels, for the whole picture, as hidden points were found before there "
                        "were pyramids; 0: hprScale's, wider near by than far away."),
        numberParameter("threshold", 0.1, 0, 0.5, "",
                        "Mean occlusion below which a point counts as hidden; 0 hides nothing."),
        numberParameter("noise", 0, 0, 1000, "cloud units",
                        "Noise of the scan, how far points lie off their surface; 0 takes what was measured "
                        "of the cloud, "
                        "if anything."),
        numberParameter(
            "minGap", -1, -1, 1000, "cloud units",
            "Points less than this in front of others are the same surface and do not hide them; 0: "
            "all hide, -1: three times the noise."),
        numberParameter("spacing", 0, 0, 1000, "cloud units",
                        "Typical distance between neighbouring points; 0 takes the cloud's own."),
        numberParameter("normalScale", 0, 0, 16, "",
                        "How wide a surface is looked at to find its slope, in point spacings; more is "
                        "smoother; 0: 2, and more where the scan is noisy."),
    };
}

}  // namespace

Method pyramidMethod() {
    Method m;
    m.name = "pyramid";
    m.title = "Reconstructed surface";
    m.summary =
        "Closes the gaps between points and lights the surface, from the picture alone: for scans "
        "without normals, as smooth as their noise allows.";
    m.source = "Raw point cloud deferred shading through screen space pyramidal operators, 2018";
    m.parameters = parameters();
    m.defaultDetail = 1.5;
    m.defaultShading = Shading::Phong;
    m.makesNormals = true;
    m.findsHidden = true;
    m.passes = pyramidPasses;
    return m;
}

}  // namespace scancast
