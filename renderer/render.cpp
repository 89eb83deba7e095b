#include "renderer/render.hpp"

#include <algorithm>
#include <glm/matrix.hpp>
#include <limits>

#include "renderer/image/clock.hpp"
#include "renderer/mirrors.hpp"
#include "renderer/plan.hpp"
#include "renderer/residency/on_device.hpp"
#include "renderer/residency/provide.hpp"
#include "renderer/style.hpp"
#include "renderer/tiled_picture.hpp"

namespace scancast {

namespace {

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

Expected<void> checkBruteForce(const Cloud& cloud) {
    const auto most = mostSamples(cloud);
    if (!most || cloud.points <= *most) return {};
    return fail(ErrorCode::ResourceLimit, "every point of this cloud does not fit the memory limit: it has " +
                                              std::to_string(cloud.points) + ", and " +
                                              std::to_string(*most) +
                                              " fit; raise the limit, or draw without --brute-force");
}

/// The runs that a picture from `camera` would draw; none where no such picture can be made.
Cut cutFrom(const Cloud& cloud, View view, const Camera& camera, const SelectOptions& selection) {
    view.camera = camera;
    const auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
    return viewpoint ? select(cloud.octree, *viewpoint, selection) : Cut();
}

/// What the camera would see if it saw everything.
Cut cutOfLevels(const Cloud& cloud, const View& view, const Camera& camera, SelectOptions selection) {
    selection.cull = selection.cullBackFaces = false;
    return cutFrom(cloud, view, camera, selection);
}

/// The runs of a reflection, with the levels that the options ask for.
Cut cutOf(const Cloud& cloud, const View& view, const Plan& plan, const Reflection& reflection,
          const RenderOptions& options) {
    SelectOptions selection = selectionOf(reflection, plan.selection);
    Viewpoint viewpoint = reflection.viewpoint;
    if (options.levelsOf) {
        View other = view;
        other.camera = *options.levelsOf;
        const auto levels = Viewpoint::create(other, cloud.origin, cloud.bounds);
        if (!levels) return {};
        const glm::dmat4 reflect = glm::inverse(plan.viewpoint.cloudToView) * viewpoint.cloudToView;
        viewpoint = *levels;
        viewpoint.cloudToView = levels->cloudToView * reflect;
        selection.cull = selection.cullBackFaces = false;
    }
    return select(cloud.octree, viewpoint, selection);
}

}  // namespace

struct PreparedView {
    const Octree* octree = nullptr;
    Plan plan;
    Cut cut;
    SampleFilter filter;
    std::vector<Reflection> reflections;
    Background background;
    bool surfels = false, oriented = false;
    int samples = 1;
    bool depth = true;
    int tileSide = largestTile;
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

namespace {

/// What the style says of mirrors.
void prepareMirrors(const Cloud& cloud, const Style& style, PreparedView& prepared) {
    if (cloud.mirrors.empty()) return;
    Plan& plan = prepared.plan;
    if (!style.behindMirrors) prepared.filter.dropped = behindMirrors(cloud);
    if (style.mirrors)
        prepared.reflections = reflectionsIn(cloud, plan.viewpoint, prepared.filter, plan.margin);
}

/// Chooses the runs of the picture and of its reflections; returns those that may be wanted soon.
Cut selectAll(const Cloud& cloud, const View& view, const RenderOptions& options, PreparedView& prepared) {
    Plan& plan = prepared.plan;
    std::vector<std::uint64_t> budgets;
    if (plan.selection.budget && !prepared.reflections.empty()) {
        const std::uint64_t budget = *plan.selection.budget;
        budgets = shareBudget(budget, plan.viewpoint, prepared.reflections);
        std::uint64_t used = 0;
        for (std::size_t i = 0; i < prepared.reflections.size(); ++i) {
            plan.selection.budget = budgets[i + 1];
            prepared.reflections[i].cut = cutOf(cloud, view, plan, prepared.reflections[i], options);
            used += prepared.reflections[i].cut.samples;
        }
        // The coarsest cut of a reflection may exceed its share: then the picture itself gets less.
        plan.selection.budget = budget - std::min(used, budget - 1);
    } else {
        for (Reflection& reflection : prepared.reflections)
            reflection.cut = cutOf(cloud, view, plan, reflection, options);
    }
    prepared.cut = options.levelsOf ? cutOfLevels(cloud, view, *options.levelsOf, plan.selection)
                                    : select(cloud.octree, plan.viewpoint, plan.selection);
    const bool looksAhead = options.ahead && !options.wait && mostSamples(cloud);
    return looksAhead ? cutFrom(cloud, view, *options.ahead, plan.selection) : Cut();
}

/// The samples of all cuts; what is missing is requested once for all.
Expected<void> provideAll(const Cloud& cloud, const RenderOptions& options, const Cut& soon,
                          PreparedView& prepared, const std::stop_token& stop) {
    std::vector<CutRun> beside;
    for (const Reflection& reflection : prepared.reflections)
        beside.insert(beside.end(), reflection.cut.runs.begin(), reflection.cut.runs.end());
    ProvideOptions provision{
        .wait = options.wait, .requester = options.requester, .ahead = soon.runs, .beside = beside};
    auto cut = provide(cloud.octree, std::move(prepared.cut), provision, stop);
    if (!cut) return tl::unexpected(cut.error());
    prepared.cut = std::move(*cut);
    provision.request = false;
    for (Reflection& reflection : prepared.reflections) {
        cut = provide(cloud.octree, std::move(reflection.cut), provision, stop);
        if (!cut) return tl::unexpected(cut.error());
        reflection.cut = std::move(*cut);
    }
    return {};
}

}  // namespace

Expected<std::shared_ptr<const PreparedView>> prepare(const Cloud& cloud, const View& view,
                                                      const RenderOptions& options, std::stop_token stop) {
    auto planned = plan(cloud, view);
    if (!planned) return tl::unexpected(planned.error());
    if (options.bruteForce) {
        if (auto fits = checkBruteForce(cloud); !fits) return tl::unexpected(fits.error());
    }
    planned->selection.bruteForce = options.bruteForce;
    if (auto& budget = planned->selection.budget; !options.wait && options.mostSamples)
        budget = std::min(budget.value_or(*options.mostSamples), *options.mostSamples);
    auto prepared = std::make_shared<PreparedView>();
    prepared->octree = &cloud.octree;
    prepared->plan = std::move(*planned);
    prepared->filter = sampleFilter(cloud, view.style);
    prepared->background = view.style.background;
    prepared->surfels = cloud.surfels;
    prepared->oriented = cloud.oriented;
    prepared->samples = view.quality.samples.value_or(defaultSamples);
    prepared->depth = options.depth;
    prepared->tileSide = std::max(options.tileSide, 1);

    auto start = Clock::now();
    prepareMirrors(cloud, view.style, *prepared);
    const Cut soon = selectAll(cloud, view, options, *prepared);
    prepared->selectMs = millisecondsSince(start);
    start = Clock::now();
    if (auto provided = provideAll(cloud, options, soon, *prepared, stop); !provided)
        return tl::unexpected(provided.error());
    prepared->provideMs = millisecondsSince(start);
    return prepared;
}

std::uint64_t samplesMissing(const PreparedView& prepared) {
    std::uint64_t missing = prepared.cut.samplesMissing;
    for (const Reflection& reflection : prepared.reflections) missing += reflection.cut.samplesMissing;
    return missing;
}

std::optional<std::uint64_t> mostSamplesOn(Device& device) {
    const DeviceMemory* const memory = device.memory();
    if (!memory) return std::nullopt;
    return std::max<std::uint64_t>(memory->capacity() / 4 * 3, 1);
}

namespace {

void addCut(const Cut& cut, FrameStats& stats) {
    stats.samplesDrawn += cut.samples;
    stats.nodesVisited += cut.nodesVisited;
    stats.nodesCulled += cut.nodesCulled;
    stats.nodesMissing += cut.nodesMissing;
    stats.samplesMissing += cut.samplesMissing;
    stats.nodesDamaged += cut.nodesDamaged;
}

/// All that a frame's statistics say but the device's stages.
FrameStats statsOf(const PreparedView& prepared, double provideMs, const Drawing& drawing,
                   std::string device) {
    FrameStats stats;
    stats.stages = {{"select", prepared.selectMs}, {"provide", provideMs}};
    stats.spacingReached = drawing.cut->spacingReached;
    stats.pointsShown = drawing.cut->points;
    addCut(*drawing.cut, stats);
    for (const Reflection& reflection : drawing.reflections) addCut(reflection.cut, stats);
    stats.mirrorsDrawn = static_cast<std::uint32_t>(drawing.reflections.size());
    stats.mirrorsLeftOut = static_cast<std::uint32_t>(prepared.reflections.size()) - stats.mirrorsDrawn;
    stats.method = prepared.plan.method;
    stats.methodReason = prepared.plan.reason;
    stats.device = std::move(device);
    return stats;
}

/// A picture's cuts as a device with memory of its own can draw them within its budget for a frame.
class CutsOnDevice {
  public:
    explicit CutsOnDevice(const PreparedView& prepared)
        : octree_(*prepared.octree), cut_(prepared.cut), reflections_(prepared.reflections) {}

    Expected<void> provide(DeviceMemory& memory, const std::stop_token& stop) {
        std::vector<Cut*> cuts{&cut_};
        for (Reflection& reflection : reflections_) cuts.push_back(&reflection.cut);
        return provideOnDevice(octree_, cuts, memory, stop);
    }
    void drawnBy(Drawing& drawing) const {
        drawing.cut = &cut_;
        drawing.reflections = reflections_;
    }

  private:
    const Octree& octree_;
    Cut cut_;
    std::vector<Reflection> reflections_;
};

/// A device's frame, and what the renderer knows of it.
class RenderedFrame final : public PendingFrame {
  public:
    RenderedFrame(std::unique_ptr<PendingFrame> pixels, FrameStats stats)
        : pixels_(std::move(pixels)), stats_(std::move(stats)) {}

    bool ready() override { return pixels_->ready(); }
    Expected<Frame> finish() override {
        auto frame = pixels_->finish();
        if (!frame) return frame;
        stats_.stages.insert(stats_.stages.end(), frame->stats.stages.begin(), frame->stats.stages.end());
        stats_.bytesUploaded = frame->stats.bytesUploaded;
        stats_.deviceBytes = frame->stats.deviceBytes;
        frame->stats = std::move(stats_);
        return frame;
    }

  private:
    std::unique_ptr<PendingFrame> pixels_;
    FrameStats stats_;
};

}  // namespace

Expected<std::unique_ptr<PendingFrame>> beginDrawing(Device& device, const PreparedView& prepared,
                                                     std::stop_token stop, Uploads uploads) {
    const auto jitter = jitterSequence(prepared.samples);
    Drawing drawing;
    drawing.viewpoint = &prepared.plan.viewpoint;
    drawing.cut = &prepared.cut;
    drawing.surfels = prepared.surfels;
    drawing.oriented = prepared.oriented;
    drawing.passes = prepared.plan.passes;
    drawing.color = prepared.plan.color;
    drawing.filter = prepared.filter;
    drawing.background = prepared.background;
    drawing.jitter = jitter;
    drawing.reflections = prepared.reflections;
    drawing.depth = prepared.depth;
    std::optional<CutsOnDevice> onDevice;
    const auto start = Clock::now();
    if (DeviceMemory* const memory = device.memory(); memory && uploads == Uploads::ForAFrame) {
        onDevice.emplace(prepared);
        if (auto provided = onDevice->provide(*memory, stop); !provided)
            return tl::unexpected(std::move(provided.error()));
        onDevice->drawnBy(drawing);
    }
    const double provideMs = prepared.provideMs + (onDevice ? millisecondsSince(start) : 0);
    const DeviceInfo info = device.info();
    if (!info.mirrors) {
        // A picture as before there were mirrors; the statistics say so.
        drawing.reflections = {};
        drawing.filter.dropped.clear();
    }
    auto pixels = beginPicture(device, drawing,
                               {prepared.tileSide, prepared.plan.margin, prepared.plan.tilesAreExact}, stop);
    if (!pixels) return pixels;
    return std::make_unique<RenderedFrame>(std::move(*pixels),
                                           statsOf(prepared, provideMs, drawing, info.name));
}

Expected<Frame> draw(Device& device, const PreparedView& prepared, std::stop_token stop, Uploads uploads) {
    auto begun = beginDrawing(device, prepared, std::move(stop), uploads);
    if (!begun) return tl::unexpected(std::move(begun.error()));
    return (*begun)->finish();
}

Expected<Frame> render(Device& device, const Cloud& cloud, const View& view, const RenderOptions& options,
                       std::stop_token stop) {
    RenderOptions here = options;
    if (!here.mostSamples) here.mostSamples = mostSamplesOn(device);
    const auto prepared = prepare(cloud, view, here, stop);
    if (!prepared) return tl::unexpected(prepared.error());
    return draw(device, **prepared, std::move(stop), options.wait ? Uploads::Everything : Uploads::ForAFrame);
}

}  // namespace scancast
