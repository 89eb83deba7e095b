#include "renderer/render.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

#include "renderer/method/method.hpp"
#include "renderer/residency/provide.hpp"
#include "renderer/style.hpp"

namespace scancast {

namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Larger pictures are drawn in tiles of at most this side, so that a poster needs no more memory than a
/// screen and can be abandoned between tiles.
constexpr int tileSide = 2048;

/// Halton points (bases 2 and 3) around their own mean: anti-aliasing must not move the picture.
std::vector<glm::dvec2> jitterSequence(int samples) {
    const auto radicalInverse = [](int i, int base) {
        double value = 0, digit = 1.0 / base;
        for (; i > 0; i /= base, digit /= base) value += digit * (i % base);
        return value;
    };
    std::vector<glm::dvec2> jitter;
    glm::dvec2 mean(0);
    for (int i = 1; i <= samples; ++i) {
        jitter.emplace_back(radicalInverse(i, 2), radicalInverse(i, 3));
        mean += jitter.back();
    }
    for (auto& shift : jitter) shift -= mean / static_cast<double>(samples);
    return jitter;
}

/// Everything that a view means for one cloud, looked up and checked.
struct Plan {
    PassList passes;
    Viewpoint viewpoint;
    ColorRule color;
    SelectOptions selection;
    int margin = 0;  ///< px around a tile that its screen passes look at
};

/// Bounds must grow by half of the largest splat, or culling would cut splats off at the picture's edge.
void growBySplats(const PassList& passes, SelectOptions& selection) {
    for (const auto& pass : passes) {
        const auto* nearest = std::get_if<NearestPass>(&pass);
        if (!nearest) continue;
        const SplatSize& size = nearest->size;
        const bool fixed = size.sizePx > 0 || nearest->footprint == Footprint::Pixel;
        const double px = fixed ? size.sizePx : size.minPx;
        selection.growPx = std::max(selection.growPx, px / 2 + 1);
        if (!fixed)
            selection.growSpacings = std::max(selection.growSpacings, static_cast<double>(size.scale));
    }
}

int screenMargin(const PassList& passes) {
    int margin = 0;
    for (const auto& pass : passes) {
        if (const auto* eyeDome = std::get_if<EyeDomePass>(&pass)) {
            margin = std::max(margin, static_cast<int>(eyeDome->radiusPx) + 2);
        }
    }
    return margin;
}

/// nullopt = as many as there are.
std::optional<std::uint64_t> mostSamples(const Cloud& cloud) {
    if (cloud.octree.nodes().empty() || cloud.octree.store().whole()) return std::nullopt;
    return cloud.octree.store().capacity();
}

Expected<void> checkBruteForce(const Cloud& cloud) {
    const auto most = mostSamples(cloud);
    if (!most || cloud.points <= *most) return {};
    return fail(ErrorCode::ResourceLimit, "every point of this cloud does not fit the memory limit: it has " +
                                              std::to_string(cloud.points) + ", and " +
                                              std::to_string(*most) +
                                              " fit; raise the limit, or draw without --brute-force");
}

Expected<Plan> plan(const Cloud& cloud, const View& view) {
    const Method* method = findMethod(view.style.method);
    if (!method) {
        std::string known;
        for (const auto& m : methods()) known += (known.empty() ? "" : ", ") + m.name;
        return fail(ErrorCode::InvalidArgument,
                    "there is no method '" + view.style.method + "'; there are " + known, "method");
    }
    const Shading shading = view.style.shading.value_or(method->defaultShading);
    if (shading == Shading::Phong) {
        return fail(ErrorCode::Unsupported, "shading=phong is not there yet; there are unlit and eyedome",
                    "shading");
    }
    auto parameters = resolveParameters(*method, view.style.parameters);
    if (!parameters) return tl::unexpected(parameters.error());
    auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
    if (!viewpoint) return tl::unexpected(viewpoint.error());
    auto color = colorRule(cloud, view.style, *viewpoint);
    if (!color) return tl::unexpected(color.error());

    Plan plan{method->passes(*method, *parameters, shading), *viewpoint, *color, {}, 0};
    plan.selection.detail = view.quality.detail.value_or(method->defaultDetail);
    plan.selection.budget = view.quality.budget;
    // A picture holds on to its samples while it is drawn: no more of them than the memory limit allows.
    if (const auto most = mostSamples(cloud);
        most && (!plan.selection.budget || *plan.selection.budget > *most))
        plan.selection.budget = most;
    growBySplats(plan.passes, plan.selection);
    plan.margin = screenMargin(plan.passes);
    return plan;
}

/// Copies the part of `tile` (which covers `drawn`) that lies in `wanted` into the whole picture.
void paste(const Frame& tile, const Window& drawn, const Window& wanted, Frame& picture) {
    for (int y = 0; y < wanted.height; ++y) {
        const auto from =
            static_cast<std::size_t>(wanted.y + y - drawn.y) * static_cast<std::size_t>(drawn.width) +
            static_cast<std::size_t>(wanted.x - drawn.x);
        const auto to = static_cast<std::size_t>(wanted.y + y) * static_cast<std::size_t>(picture.width) +
                        static_cast<std::size_t>(wanted.x);
        const auto count = static_cast<std::size_t>(wanted.width);
        std::copy_n(tile.rgba.begin() + static_cast<std::ptrdiff_t>(from * 4), count * 4,
                    picture.rgba.begin() + static_cast<std::ptrdiff_t>(to * 4));
        std::copy_n(tile.depth.begin() + static_cast<std::ptrdiff_t>(from), count,
                    picture.depth.begin() + static_cast<std::ptrdiff_t>(to));
    }
}

/// The wanted window and the margin around it that lies inside the picture.
Window withMargin(const Window& wanted, int margin, int width, int height) {
    Window drawn;
    drawn.x = std::max(0, wanted.x - margin);
    drawn.y = std::max(0, wanted.y - margin);
    drawn.width = std::min(width, wanted.x + wanted.width + margin) - drawn.x;
    drawn.height = std::min(height, wanted.y + wanted.height + margin) - drawn.y;
    return drawn;
}

Expected<Frame> drawTiles(Device& device, Drawing drawing, int margin, const std::stop_token& stop) {
    const int width = drawing.viewpoint->width, height = drawing.viewpoint->height;
    if (width <= tileSide && height <= tileSide) {
        drawing.window = {0, 0, width, height};
        return device.draw(drawing, stop);
    }
    Frame picture{width, height, {}, {}, {}};
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    picture.rgba.resize(pixels * 4);
    picture.depth.resize(pixels);
    for (int y = 0; y < height; y += tileSide) {
        for (int x = 0; x < width; x += tileSide) {
            const Window wanted{x, y, std::min(tileSide, width - x), std::min(tileSide, height - y)};
            drawing.window = withMargin(wanted, margin, width, height);
            auto tile = device.draw(drawing, stop);
            if (!tile) return tile;
            paste(*tile, drawing.window, wanted, picture);
            for (const auto& stage : tile->stats.stages) picture.stats.add(stage.name, stage.milliseconds);
        }
    }
    return picture;
}

/// The runs that a picture from `camera` would draw; none where no such picture can be made.
Cut cutFrom(const Cloud& cloud, View view, const Camera& camera, const SelectOptions& selection) {
    view.camera = camera;
    const auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
    return viewpoint ? select(cloud.octree, *viewpoint, selection) : Cut();
}

}  // namespace

struct PreparedView {
    Plan plan;
    Cut cut;
    SampleFilter filter;
    Background background;
    std::string method;
    int samples = 1;
    double selectMs = 0, provideMs = 0;
};

View defaultView(const Cloud& cloud, int width, int height) {
    View view;
    view.width = width;
    view.height = height;
    view.camera = cloud.defaultCamera(static_cast<double>(width) / height);
    view.style.color = bestColorSource(cloud.attributes);
    return view;
}

Expected<void> checkView(const Cloud& cloud, const View& view) {
    if (auto planned = plan(cloud, view); !planned) return tl::unexpected(planned.error());
    return {};
}

Expected<std::shared_ptr<const PreparedView>> prepare(const Cloud& cloud, const View& view,
                                                      const RenderOptions& options, std::stop_token stop) {
    auto planned = plan(cloud, view);
    if (!planned) return tl::unexpected(planned.error());
    if (options.bruteForce) {
        if (auto fits = checkBruteForce(cloud); !fits) return tl::unexpected(fits.error());
    }
    auto prepared = std::make_shared<PreparedView>();
    auto start = Clock::now();
    planned->selection.bruteForce = options.bruteForce;
    Cut wanted = select(cloud.octree, planned->viewpoint, planned->selection);
    Cut soon;
    if (options.ahead && !options.wait && mostSamples(cloud))
        soon = cutFrom(cloud, view, *options.ahead, planned->selection);
    prepared->selectMs = millisecondsSince(start);

    start = Clock::now();
    auto cut = provide(cloud.octree, std::move(wanted),
                       {.wait = options.wait, .requester = options.requester, .ahead = soon.runs}, stop);
    if (!cut) return tl::unexpected(cut.error());
    prepared->provideMs = millisecondsSince(start);
    prepared->cut = std::move(*cut);
    prepared->plan = std::move(*planned);
    prepared->filter = sampleFilter(cloud, view.style);
    prepared->background = view.style.background;
    prepared->method = view.style.method;
    prepared->samples = view.quality.samples.value_or(defaultSamples);
    return prepared;
}

std::uint64_t samplesMissing(const PreparedView& prepared) {
    return prepared.cut.samplesMissing;
}

Expected<Frame> draw(Device& device, const PreparedView& prepared, std::stop_token stop) {
    const Cut& cut = prepared.cut;
    const auto jitter = jitterSequence(prepared.samples);
    Drawing drawing;
    drawing.viewpoint = &prepared.plan.viewpoint;
    drawing.cut = &cut;
    drawing.passes = prepared.plan.passes;
    drawing.color = prepared.plan.color;
    drawing.filter = prepared.filter;
    drawing.background = prepared.background;
    drawing.jitter = jitter;
    auto frame = drawTiles(device, drawing, prepared.plan.margin, stop);
    if (!frame) return frame;

    FrameStats& stats = frame->stats;
    const std::array<StageTime, 2> before{StageTime{"select", prepared.selectMs},
                                          StageTime{"provide", prepared.provideMs}};
    stats.stages.insert(stats.stages.begin(), before.begin(), before.end());
    stats.samplesDrawn = cut.samples;
    stats.pointsShown = cut.points;
    stats.nodesVisited = cut.nodesVisited;
    stats.nodesCulled = cut.nodesCulled;
    stats.spacingReached = cut.spacingReached;
    stats.nodesMissing = cut.nodesMissing;
    stats.samplesMissing = cut.samplesMissing;
    stats.nodesDamaged = cut.nodesDamaged;
    stats.method = prepared.method;
    stats.device = device.info().name;
    return frame;
}

Expected<Frame> render(Device& device, const Cloud& cloud, const View& view, const RenderOptions& options,
                       std::stop_token stop) {
    const auto prepared = prepare(cloud, view, options, stop);
    if (!prepared) return tl::unexpected(prepared.error());
    return draw(device, **prepared, std::move(stop));
}

}  // namespace scancast
