#include "renderer/plan.hpp"

#include <algorithm>

#include "protocol/nearest_name.hpp"
#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/device/host/screens.hpp"
#include "renderer/method/automatic.hpp"
#include "renderer/method/light.hpp"
#include "renderer/method/method.hpp"
#include "renderer/select/fade.hpp"
#include "renderer/style.hpp"
#include "renderer/sun.hpp"
#include "renderer/together/together_columns.hpp"

namespace scancast {
namespace {

/// Pixels around a tile that hidden point removal and pull-push look at.
constexpr int hiddenPointsMargin = 128;

/// τ of what the sun sees, px of the map of shadows; and how far a surface may lie behind itself there: by the softness
/// of look-ups, px, and by the size of splats.
constexpr double shadowDetail = 1.5, biasInPixels = 2, biasInSpacings = 1.5;

/// Bounds must grow by half of the largest splat, or culling would cut splats off at the picture's edge.
/// `factor`: how much larger than `splat` says, and than a node's spacing, they may be.
void growBySplat(const Splat& splat, double factor, SelectOptions& selection) {
    const bool fixed = !ofSurfels(splat) && (splat.size.sizePx > 0 || splat.footprint == Footprint::Pixel);
    const double px = fixed ? splat.size.sizePx : splat.size.minPx + 6 * splat.lowPassPx;
    selection.growPx = std::max(selection.growPx, px / 2 + 1);
    if (!fixed) selection.growSpacings = std::max(selection.growSpacings, splat.size.scale * factor);
}

void growBySplats(const PassList& passes, bool surfels, SelectOptions& selection) {
    // A sample's own radius is at most so many of its node's spacings.
    const double largest = surfels ? double(surfelRadii()[outlierRadius - 1]) : 1.0;
    for (const auto& pass : passes) {
        if (const auto* nearest = std::get_if<NearestPass>(&pass)) {
            const bool ellipse = nearest->footprint == Footprint::Ellipse;
            growBySplat(*nearest, ellipse ? largest * majorPerRadius : largest, selection);
        }
        if (const auto* sum = std::get_if<SumPass>(&pass); sum && sum->footprint == Footprint::Disc)
            growBySplat(*sum, largest * sum->reach, selection);
        if (std::holds_alternative<HiddenPointsPass>(pass))
            selection.growPx = std::max(selection.growPx, double(pyramidGuardBand + 1));
    }
}

/// The pyramid of hidden points and colours reaches farther than any margin that a tile could have.
bool looksNoFartherThanTheMargin(const PassList& passes) {
    return std::ranges::none_of(passes, [](const Pass& pass) {
        return std::holds_alternative<HiddenPointsPass>(pass) || std::holds_alternative<PullPushPass>(pass);
    });
}

/// Whether nothing that faces away from the eye is drawn by any pass.
bool drawsFrontOnly(const PassList& passes) {
    const auto front = [](const Pass& pass) {
        if (std::holds_alternative<SilhouettePass>(pass)) return false;
        const auto* nearest = std::get_if<NearestPass>(&pass);
        return nearest == nullptr || (ofSurfels(*nearest) && nearest->facing == Facing::Front);
    };
    return std::ranges::all_of(passes, front);
}

int screenMargin(const PassList& passes) {
    int margin = 0;
    for (const auto& pass : passes) {
        if (const auto* resolve = std::get_if<ResolvePass>(&pass); resolve && resolve->smooth)
            margin = std::max(margin, 1);
        if (const auto* eyeDome = std::get_if<EyeDomePass>(&pass)) {
            margin = std::max(margin, static_cast<int>(eyeDome->radiusPx) + 2);
        }
        if (const auto* occlusion = std::get_if<OcclusionPass>(&pass))
            margin = std::max(margin, occlusionReach(*occlusion));
        if (std::holds_alternative<HiddenPointsPass>(pass)) margin = std::max(margin, hiddenPointsMargin);
    }
    return margin;
}

CloudTraits traits(const Cloud& cloud) {
    return {.surfels = cloud.surfels,
            .oriented = cloud.oriented || cloud.sides,
            .normals = cloud.surfels || cloud.attributes.normal,
            .colors = cloud.attributes.color,
            .spacing = cloud.spacing,
            .noise = cloud.look ? cloud.look->noise : 0,
            .up = cloud.look ? cloud.look->up : glm::dvec3(0, 0, 1)};
}

/// Whether the cloud has what the method and its shading draw, and the method what is to be shown.
Expected<void> checkAbility(const Cloud& cloud, const Method& method, Shading shading, ColorSource color) {
    if (color == ColorSource::Visibility && !method.findsHidden)
        return fail(ErrorCode::Unsupported,
                    "color=visibility shows which points hidden point removal takes away, and method '" +
                        method.name + "' has none; use method=pyramid",
                    "color");
    if (method.needs == Needs::Surfels && !cloud.surfels)
        return fail(ErrorCode::Unsupported,
                    "method '" + method.name +
                        "' draws surfels, and this cloud was built without them; ingest the scan without "
                        "--no-surfels (scancast ingest SCAN -o CLOUD.scan), or use paraboloid or pyramid",
                    "method");
    if (shading == Shading::Phong && !method.makesNormals && !traits(cloud).normals)
        return fail(ErrorCode::Unsupported,
                    "shading=phong needs normals, and this cloud has none; ingest the scan without "
                    "--no-surfels, use method=pyramid, which makes its own, or shading=eyedome",
                    "shading");
    return {};
}

/// Whether it has what the passes draw of it.
Expected<void> checkPasses(const Cloud& cloud, const PassList& passes) {
    const auto clips = [](const Pass& pass) { return std::holds_alternative<SilhouettePass>(pass); };
    if (!traits(cloud).oriented && std::ranges::any_of(passes, clips))
        return fail(
            ErrorCode::Unsupported,
            "param.silhouette=true clips outlines by what faces away, and of no surface of this cloud "
            "is it known which side faces out, so it would do nothing; leave it out, or, if the scan "
            "was taken from the air, ingest it with --orient up",
            "param.silhouette");
    return {};
}

/// A method with complete parameters, its light, and why it was chosen where the request left that open.
struct ChosenMethod {
    const Method* method = nullptr;
    ParameterValues parameters;
    Shading shading = Shading::Unlit;
    LightRig light;
    std::string reason;
};

/// Of a style that leaves the method open: what the chosen one has; parameters of others wait for views in which
/// those are chosen.
Expected<ParameterValues> parametersOfChosen(const Method& chosen, const ParameterValues& given) {
    ParameterValues own;
    for (const auto& [name, value] : given) {
        const auto has = [&](const Method& m) {
            return std::ranges::find(m.parameters, name, &Parameter::name) != m.parameters.end();
        };
        if (has(chosen))
            own.emplace(name, value);
        else if (std::ranges::none_of(methods(), has))
            return resolveParameters(chosen, {{name, value}});  // its error tells what there is
    }
    return resolveParameters(chosen, own);
}

Expected<const Method*> namedMethod(const std::string& name) {
    if (const Method* const named = findMethod(name)) return named;
    std::string names;
    for (const auto& m : methods()) names += (names.empty() ? "" : ", ") + m.name;
    return fail(ErrorCode::InvalidArgument, "there is no method '" + name + "'; there are " + names,
                "method");
}

/// Whether there is a method that takes it.
Expected<void> checkForSomeMethod(const std::string& name, const ParameterValue& value) {
    std::vector<std::string_view> names;
    std::optional<Error> wrong;
    for (const Method& method : methods()) {
        for (const Parameter& parameter : method.parameters) names.push_back(parameter.name);
        if (std::ranges::find(method.parameters, name, &Parameter::name) == method.parameters.end()) continue;
        const auto resolved = resolveParameters(method, {{name, value}});
        if (resolved) return {};
        wrong = resolved.error();
    }
    if (wrong) return tl::unexpected(*wrong);
    std::ranges::sort(names);
    names.erase(std::ranges::unique(names).begin(), names.end());
    return fail(ErrorCode::InvalidArgument, unknownName("param." + name.substr(0, 64), name, names), "param");
}

/// Where the method is left open the look says how it is lit; a method that is named brings its own light.
Expected<ChosenMethod> choose(const Cloud& cloud, const Style& style) {
    const auto found = namedMethod(style.method);
    if (!found) return passOn(found);
    const Method* const named = *found;
    const bool isOpen = named->name == automaticName;
    const AutomaticChoice choice =
        isOpen ? chooseMethod(traits(cloud)) : AutomaticChoice{named, named->defaultShading, {}};
    const Style ofLook = isOpen && !style.shading && cloud.look ? cloud.look->style : Style();
    LightRig light = style.light;
    light.occlusion = style.light.occlusion.value_or(ofLook.light.occlusion.value_or(0));
    auto parameters = isOpen ? parametersOfChosen(*choice.method, style.parameters)
                             : resolveParameters(*choice.method, style.parameters);
    if (!parameters) return passOn(parameters);
    return ChosenMethod{choice.method, std::move(*parameters),
                        style.shading.value_or(ofLook.shading.value_or(choice.shading)), light,
                        choice.reason};
}

/// How to select what the passes draw.
SelectOptions selectionFor(const Cloud& cloud, const Octree& octree, const View& view, double detail,
                           const PassList& passes) {
    SelectOptions selection;
    selection.detail = detail;
    selection.fade = fadeBand(detail);
    selection.budget = view.quality.budget;
    // A picture holds on to its samples while it is drawn: no more of them than the memory limit allows.
    if (const auto most = mostSamples(octree))
        selection.budget = std::min(selection.budget.value_or(*most), *most);
    growBySplats(passes, cloud.surfels, selection);
    selection.cullBackFaces = (cloud.oriented || cloud.sides) && drawsFrontOnly(passes);
    selection.sureNodesOnly = !cloud.oriented;
    return selection;
}

/// Whether anything that is drawn asks how surfaces bend.
bool looksAtCurvatures(const PassList& passes, const ColorRule& color) {
    const auto asks = [](const Pass& pass) {
        if (const auto* const sum = std::get_if<SumPass>(&pass)) return sum->normals && sum->curved;
        const auto* const resolve = std::get_if<ResolvePass>(&pass);
        return resolve && resolve->normals && resolve->curved;
    };
    return color.source == ColorSource::Curvature || std::ranges::any_of(passes, asks);
}

/// Where the passes ask for shadows: what the sun sees, and how much in front of a surface what it sees must lie.
void planShadows(const Cloud& cloud, PlannedView& planned) {
    const auto asks = [](const Pass& pass) { return std::holds_alternative<ShadowPass>(pass); };
    const auto found = std::ranges::find_if(planned.passes, asks);
    if (found == planned.passes.end()) return;
    const auto& bounds = cloud.look ? cloud.look->bounds : cloud.bounds;
    const CloudTraits cloudTraits = traits(cloud);
    planned.sun = sunViewpoint({bounds[0] - cloud.origin, bounds[1] - cloud.origin}, planned.viewpoint,
                               wayToSun(*planned.view.style.light.sun, cloudTraits.up));
    if (!planned.sun) return;
    planned.sunSelection = planned.selection;
    planned.sunSelection.fade = 0;
    planned.sunSelection.cullBackFaces = false;
    planned.sunSelection.detail = shadowDetail;
    growBySplats({shadowMapPasses(cloud.surfels).nearest}, cloud.surfels, planned.sunSelection);
    const double pixel = 1 / planned.sun->pixelsPerUnit;
    std::get<ShadowPass>(*found).bias = static_cast<float>(
        biasInPixels * pixel + biasInSpacings * std::max(shadowDetail * pixel, cloud.spacing));
}

/// The style with open whatever the look decides where nothing is said: so naming another colour or method brings
/// nothing of the look's along - no range of heights for intensities, no light of another method.
Style leftOpen(Style style) {
    const Style open;
    style.color = open.color;
    style.column = open.column;
    style.flatColor = open.flatColor;
    style.byIntensity = open.byIntensity;
    style.exposure = open.exposure;
    style.colormap = open.colormap;
    style.range = open.range;
    if (style.method == automaticName) {
        style.shading = open.shading;
        style.light.occlusion = open.light.occlusion;
    }
    return style;
}

}  // namespace

std::optional<std::uint64_t> mostSamples(const Octree& octree) {
    if (octree.nodes().empty() || octree.store().whole()) return std::nullopt;
    return octree.store().capacity();
}

Expected<std::shared_ptr<const PlannedView>> plan(const Cloud& cloud, const View& view) {
    auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
    if (!viewpoint) return passOn(viewpoint);
    const auto chosen = choose(cloud, view.style);
    if (!chosen) return passOn(chosen);
    const Method* const method = chosen->method;
    const Style style = withColumnEnds(cloud, decidedStyle(cloud, view.style));
    if (auto ok = checkAbility(cloud, *method, chosen->shading, style.color); !ok) return passOn(ok);
    auto color = colorRule(cloud, style, *viewpoint);
    if (!color) return passOn(color);
    auto pictured = picturedOctreeOf(cloud, style);
    if (!pictured) return passOn(pictured);

    auto planned = std::make_shared<PlannedView>();
    planned->view = view;
    planned->method = method->name;
    planned->reason = chosen->reason;
    planned->viewpoint = *viewpoint;
    planned->colorName = colorWord(style);
    planned->colormap = style.colormap;
    planned->colorRange = rampEnds(cloud, style, *viewpoint);
    planned->exposure = *style.exposure;
    planned->color = *color;
    planned->filter = sampleFilter(cloud, view.style);
    planned->pictured = std::move(*pictured);
    const double detail = view.quality.detail.value_or(method->defaultDetail);
    planned->passes = method->passes({*method, chosen->parameters, chosen->shading, traits(cloud), detail,
                                      chosen->light, view.height, style.color == ColorSource::Visibility,
                                      view.quality.samples.value_or(defaultSamples)});
    if (auto ok = checkPasses(cloud, planned->passes); !ok) return passOn(ok);
    planned->curvatures = hasCurvature(cloud) && looksAtCurvatures(planned->passes, planned->color);
    planned->beside = planned->curvatures || planned->color.source == ColorSource::Infrared;
    planned->selection = selectionFor(cloud, octreeOf(cloud, *planned), view, detail, planned->passes);
    planned->selection.clip = planned->filter.clip;
    planned->selection.shapes = planned->filter.shapes;
    planShadows(cloud, *planned);
    planned->margin = screenMargin(planned->passes);
    planned->tilesAreExact = looksNoFartherThanTheMargin(planned->passes);
    return planned;
}

Expected<void> checkMethod(const Style& style) {
    const auto named = namedMethod(style.method);
    if (!named) return passOn(named);
    if ((*named)->name != automaticName) {
        const auto resolved = resolveParameters(**named, style.parameters);
        return resolved ? Expected<void>() : passOn(resolved);
    }
    // Which one it will be nobody knows yet: each parameter must be sound for some method.
    for (const auto& [name, value] : style.parameters)
        if (auto ok = checkForSomeMethod(name, value); !ok) return ok;
    return {};
}

Expected<void> checkView(const Cloud& cloud, const View& view) {
    if (auto ok = plan(cloud, view); !ok) return passOn(ok);
    return {};
}

std::vector<LookView> viewsOf(const Cloud& cloud, double aspect) {
    if (!cloud.look) return {{"whole", false, cloud.defaultCamera(aspect)}};
    std::vector<LookView> views = cloud.look->views;
    for (LookView& view : views) view.camera = cameraFor(*cloud.look, view, aspect);
    return views;
}

View defaultView(const Cloud& cloud, int width, int height) {
    View view;
    view.width = width;
    view.height = height;
    const double aspect = static_cast<double>(width) / height;
    if (!cloud.look) {
        view.camera = cloud.defaultCamera(aspect);
        return view;
    }
    view.camera = cameraFor(*cloud.look, cloud.look->views.front(), aspect);
    view.style = leftOpen(cloud.look->style);
    return view;
}

}  // namespace scancast
