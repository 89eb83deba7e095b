#include "renderer/device/gl/draw_plan.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>

#include "renderer/cloud/surfel_codec.hpp"
#include "renderer/device/plan/colors.hpp"
#include "renderer/select/fade.hpp"

namespace scancast::gl {
namespace {

struct PassNames {
    NearestPass nearest;
    std::optional<EyeDomePass> eyeDome;
};

bool drawsSprites(const NearestPass& pass) {
    return pass.payload == Payload::Color && !ofSurfels(pass);
}

Expected<PassNames> namePasses(std::span<const Pass> passes) {
    const bool known = (passes.size() == 2 || passes.size() == 3) &&
                       std::holds_alternative<NearestPass>(passes[0]) &&
                       std::holds_alternative<ResolvePass>(passes[1]) &&
                       (passes.size() == 2 || std::holds_alternative<EyeDomePass>(passes[2]));
    if (!known || !drawsSprites(std::get<NearestPass>(passes[0])))
        return fail(ErrorCode::Unsupported,
                    "OpenGL devices draw sprites, unlit or with eye-dome lighting; this method needs other "
                    "passes. Use --backend=cpu for it.");
    PassNames names{std::get<NearestPass>(passes[0]), std::nullopt};
    if (passes.size() == 3) names.eyeDome = std::get<EyeDomePass>(passes[2]);
    return names;
}

Expected<void> checkWindow(const Drawing& d) {
    const Window& w = d.window;
    if (!d.viewpoint || !d.cut || d.jitter.empty())
        return fail(ErrorCode::Internal, "A drawing needs a viewpoint, a cut and at least one frame.");
    if (w.width < 1 || w.height < 1 || w.x < 0 || w.y < 0 || w.width > d.viewpoint->width - w.x ||
        w.height > d.viewpoint->height - w.y)
        return fail(ErrorCode::InvalidArgument, "The window to draw lies outside the picture of " +
                                                    std::to_string(d.viewpoint->width) + " x " +
                                                    std::to_string(d.viewpoint->height) + " pixels.");
    return {};
}

/// Eye-dome lighting looks at pixels this far beyond the window.
int reachOf(const std::optional<EyeDomePass>& eyeDome) {
    return eyeDome ? static_cast<int>(std::ceil(std::clamp(eyeDome->radiusPx, 0.0f, 64.0f))) : 0;
}

/// The window and what is looked at beyond it, as far as there is a picture.
ivec4 areaOf(const Window& w, int reach, const Viewpoint& viewpoint) {
    const int x0 = std::max(0, w.x - reach), y0 = std::max(0, w.y - reach);
    const int x1 = std::min(viewpoint.width, w.x + w.width + reach);
    const int y1 = std::min(viewpoint.height, w.y + w.height + reach);
    return {x0, y0, x1 - x0, y1 - y0};
}

/// Shared with the cpu device, word for word: the same floats go into the same arithmetic.
PassParams passParams(const Viewpoint& viewpoint, const NearestPass& nearest, const ColorRule& rule,
                      ivec4 area) {
    PassParams pass;
    pass.view = {static_cast<float>(viewpoint.width * 0.5), static_cast<float>(viewpoint.height * 0.5),
                 std::max(static_cast<float>(viewpoint.near), FLT_MIN),
                 std::min(static_cast<float>(viewpoint.far), farthestDepth)};
    pass.area = area;
    // A size of nothing would divide by nothing; the centre's pixel is drawn anyway.
    const auto bounded = [](float px) { return px > 1e-3f ? std::min(px, 16384.0f) : 1e-3f; };
    float minPx = 1, maxPx = 1;
    if (nearest.footprint != Footprint::Pixel) {
        const bool fixed = nearest.size.sizePx > 0;
        minPx = bounded(fixed ? nearest.size.sizePx : nearest.size.minPx);
        maxPx = std::max(bounded(fixed ? nearest.size.sizePx : nearest.size.maxPx), minPx);
    }
    const bool flat = nearest.profile == Profile::Flat || !(nearest.gain > 0);
    pass.size = {minPx, maxPx, static_cast<float>(std::min(1 / viewpoint.pixelsPerUnit, 1e30)),
                 flat ? 0.0f : std::min(nearest.gain, 1000.0f)};
    // A range of no width puts everything at the ramp's beginning.
    const double width = rule.high - rule.low;
    const float scale = std::isnormal(width) ? static_cast<float>(255.0 / width) : 0.0f;
    pass.ramp = {static_cast<float>(rule.low), scale, 0, 0};
    return pass;
}

std::vector<std::uint32_t> colorTable(const ColorRule& rule, const SampleFilter& filter) {
    std::vector<std::uint32_t> table(512, 1);
    for (std::size_t i = 0; i < 256; ++i) {
        table[i] = packed(rule.ramp[i]);
        if (filter.classes) table[256 + i] = (*filter.classes)[i] ? 1 : 0;
    }
    for (const float radius : surfelRadii()) table.push_back(std::bit_cast<std::uint32_t>(radius));
    if (rule.source != ColorSource::Normal) return table;
    // -1 … 1 → 0 … 255 per axis; no normal is mid grey.
    const auto channel = [](float v) {
        return static_cast<std::uint8_t>(std::lround((std::clamp(v, -1.0f, 1.0f) * 0.5f + 0.5f) * 255));
    };
    for (std::uint32_t code = 0; code < 65536; ++code) {
        const glm::vec3 n = decodeNormal(static_cast<std::uint16_t>(code));
        table.push_back(packed({channel(n.x), channel(n.y), channel(n.z)}));
    }
    return table;
}

EyeDomeParams eyeDomeParams(const EyeDomePass& pass, ivec4 area, const Window& w) {
    EyeDomeParams params{};
    params.area = area;
    params.window = {w.x, w.y, w.width, w.height};
    const double radius = std::clamp(pass.radiusPx, 0.0f, 64.0f);
    for (int k = 0; k < 8; ++k) {
        const double angle = k * 0.785398163397448309616;
        params.offsets[k / 2][k % 2 * 2] = static_cast<int>(std::lround(radius * std::cos(angle)));
        params.offsets[k / 2][k % 2 * 2 + 1] = static_cast<int>(std::lround(radius * std::sin(angle)));
    }
    constexpr double log2e = 1.44269504088896340736;
    params.strength.x = static_cast<float>(300.0 * std::clamp(pass.strength, 0.0f, 1000.0f) / 8 * log2e);
    return params;
}

/// Rows of toPicture: node → view → picture, composed in double, so that no large coordinate reaches a float
/// sum.
bool setToPicture(const Node& node, const Viewpoint& viewpoint, RunParams& run) {
    const glm::dvec4 base = viewpoint.cloudToView * glm::dvec4(node.boxMin, 1);
    // Across the picture, down it (rows grow downwards), into it.
    const double scale[3] = {viewpoint.pixelsPerUnit, -viewpoint.pixelsPerUnit, -1};
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) {
            const double value = scale[r] * (c < 3 ? viewpoint.cloudToView[c][r] * node.step[c] : base[r]);
            if (!(std::abs(value) < largestCoefficient)) return false;
            run.toPicture[r][c] = static_cast<float>(value);
        }
    }
    return true;
}

/// First and last integer i in [0, 65535] with low ≤ base + step · i ≤ high, as octree.hpp's position()
/// computes it.
bool clipAxis(double base, double step, double low, double high, int& first, int& last) {
    const auto place = [&](int i) { return base + step * i; };
    const auto rounded = [](double v) { return static_cast<int>(std::clamp(v, -1.0, 65536.0)); };
    first = std::max(0, rounded((low - base) / step) - 1);
    while (first <= 65535 && place(first) < low) ++first;
    last = std::min(65535, rounded((high - base) / step) + 1);
    while (last >= 0 && place(last) > high) --last;
    return first <= last;
}

/// nullopt: nothing of the run can be drawn.
std::optional<RunParams> runParams(const CutRun& cutRun, const Drawing& d, const NearestPass& nearest) {
    const Node& node = *cutRun.node;
    RunParams run{};
    if (cutRun.samples.empty() || !setToPicture(node, *d.viewpoint, run)) return std::nullopt;
    run.clipMax = ivec4(65535);
    if (const auto& clip = d.filter.clip) {
        for (int a = 0; a < 3; ++a) {
            if (!clipAxis(node.boxMin[a], node.step[a], clip->min[a], clip->max[a], run.clipMin[a],
                          run.clipMax[a]))
                return std::nullopt;
        }
    }
    const double factor = 2.0 * node.spacing * nearest.size.scale * d.viewpoint->pixelsPerUnit;
    const double width = d.color.high - d.color.low;
    const double colorScale = std::isnormal(width) ? static_cast<float>(255.0 / width) : 0.0f;
    run.factors = {static_cast<float>(std::clamp(factor, 0.0, 1e30)),
                   static_cast<float>(node.step.z * colorScale),
                   static_cast<float>((node.boxMin.z - d.color.low) * colorScale),
                   d.surfels ? node.radiusUnit / node.spacing : 0.0f};
    run.color.y = lastTurn(cutRun.share);
    if (d.color.source == ColorSource::Flat) run.color.x = packed(d.color.flat);
    if (d.color.source == ColorSource::Lod) run.color.x = packed(d.color.ramp[node.level]);
    return run;
}

/// Deals a run's samples out to pages, and each page's part to chunks.
void addSamples(DrawPlan& plan, std::span<const Sample> samples, std::uint32_t run,
                std::uint32_t pageSamples) {
    std::uint32_t index = 0;  // in the run
    while (!samples.empty()) {
        if (plan.pages.empty() || plan.pages.back().samples == pageSamples) {
            plan.pages.emplace_back();
            plan.pages.back().firstChunk = static_cast<std::uint32_t>(plan.chunks.size());
        }
        SamplePage& page = plan.pages.back();
        const auto count =
            static_cast<std::uint32_t>(std::min<std::size_t>(samples.size(), pageSamples - page.samples));
        page.segments.push_back(samples.first(count));
        for (std::uint32_t first = 0; first < count; first += chunkSamples) {
            plan.chunks.push_back(
                {uvec4(page.samples + first, std::min(chunkSamples, count - first), run, index + first)});
            ++page.chunks;
        }
        page.samples += count;
        index += count;
        samples = samples.subspan(count);
    }
}

Expected<void> addRuns(DrawPlan& plan, const Drawing& d, const NearestPass& nearest, const GlLimits& limits) {
    const auto pageSamples =
        static_cast<std::uint32_t>(std::min(limits.storageBlockBytes, largestPageBytes) / sizeof(Sample));
    for (const CutRun& cutRun : d.cut->runs) {
        const auto run = runParams(cutRun, d, nearest);
        if (!run) continue;
        addSamples(plan, cutRun.samples, static_cast<std::uint32_t>(plan.runs.size()), pageSamples);
        plan.runs.push_back(*run);
    }
    if (plan.runs.size() * sizeof(RunParams) > limits.storageBlockBytes ||
        plan.chunks.size() * sizeof(Chunk) > limits.storageBlockBytes)
        return fail(ErrorCode::ResourceLimit,
                    "The cut has " + std::to_string(plan.runs.size()) +
                        " runs, more than the OpenGL driver takes at once; ask for less "
                        "detail or use --backend=cpu.");
    return {};
}

}  // namespace

std::vector<Define> NearestVariant::defines(int stage) const {
    std::vector<Define> all{
        {"STAGE", stage},
        {"GROUP_SIZE", 128},
        {"TURN_STEP", static_cast<int>(turnStep)},
        {"SHAPE", static_cast<int>(shape)},
        {"COLORING", stage == 0 ? 0 : static_cast<int>(coloring)},  // colour decides no order
        {"PERSPECTIVE", perspective},
        {"SINGLE_PIXEL", singlePixel},
        {"CLASSES", classes},
        {"CLIPPED", clipped}};
    constexpr std::array shapes{"FLAT_SQUARE", "FLAT_CIRCLE", "PARABOLOID_SQUARE", "PARABOLOID_CIRCLE",
                                "CONE_SQUARE", "CONE_CIRCLE", "SPHERE_CIRCLE"};
    constexpr std::array colorings{"COLOR_RGB",       "COLOR_PER_RUN",        "COLOR_INTENSITY",
                                   "COLOR_ELEVATION", "COLOR_CLASSIFICATION", "COLOR_NORMAL",
                                   "COLOR_DEPTH"};
    for (std::size_t i = 0; i < shapes.size(); ++i) all.push_back({shapes[i], static_cast<int>(i)});
    for (std::size_t i = 0; i < colorings.size(); ++i) all.push_back({colorings[i], static_cast<int>(i)});
    return all;
}

Expected<DrawPlan> planDrawing(const Drawing& d, const GlLimits& limits) {
    if (auto checked = checkWindow(d); !checked) return tl::unexpected(checked.error());
    const auto names = namePasses(d.passes);
    if (!names) return tl::unexpected(names.error());
    const ivec4 area = areaOf(d.window, reachOf(names->eyeDome), *d.viewpoint);
    if (static_cast<std::size_t>(area.z) * static_cast<std::size_t>(area.w) * 4 > limits.storageBlockBytes)
        return fail(ErrorCode::ResourceLimit,
                    "A window of " + std::to_string(d.window.width) + " x " +
                        std::to_string(d.window.height) +
                        " pixels does not fit a storage block of this OpenGL driver; draw "
                        "it in parts.");
    DrawPlan plan;
    plan.window = {d.window.x, d.window.y, d.window.width, d.window.height};
    plan.center = {d.viewpoint->width * 0.5, d.viewpoint->height * 0.5};
    plan.pass = passParams(*d.viewpoint, names->nearest, d.color, area);
    plan.variant = {splatShape(names->nearest.footprint, names->nearest.profile),
                    splatColoring(d.color.source),
                    d.viewpoint->projection == Projection::Perspective,
                    plan.pass.size.y <= 1,
                    d.filter.classes.has_value(),
                    d.filter.clip.has_value()};
    plan.colors = colorTable(d.color, d.filter);
    plan.background = backgroundRows(d.background, area.y, area.w, d.viewpoint->height);
    if (names->eyeDome) plan.eyeDome = eyeDomeParams(*names->eyeDome, area, d.window);
    if (auto added = addRuns(plan, d, names->nearest, limits); !added) return tl::unexpected(added.error());
    return plan;
}

}  // namespace scancast::gl
