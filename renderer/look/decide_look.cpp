#include "renderer/look/decide_look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "renderer/look/candidates.hpp"
#include "renderer/look/choose_style.hpp"
#include "renderer/look/picture_measure.hpp"
#include "renderer/look/survey.hpp"
#include "renderer/look/surveyed_scene.hpp"
#include "renderer/render.hpp"

namespace scancast {

namespace {

constexpr std::size_t surveyPoints = 12000;
/// Of the small pictures, px.
constexpr int width = 192, height = 108;
/// A style is judged in a picture as people get it, so many times as wide and high.
constexpr int styleScale = 6;
/// Fewer than fit the least memory that clouds are served with (64 MB): so no memory limit changes a look.
constexpr std::uint64_t mostSamplesDrawn = 1'000'000;
/// Light may make points of a photographed surface differ by so much more than their own colours do.
constexpr double noiseByLight = 0.003;

struct Scored {
    LookView view;
    double score = 0;
    PictureMeasure measure;
};

/// Share of the scene's points that the picture shows: not hidden behind others.
double shownShare(const SurveyedScene& scene, const Cloud& cloud, const View& view, const Frame& frame) {
    const auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
    if (!viewpoint) return 0;
    std::size_t shown = 0;
    for (const SurveyPoint& p : scene.points) {
        const glm::dvec3 seen(viewpoint->cloudToView * glm::dvec4(p.position - cloud.origin, 1));
        if (-seen.z <= viewpoint->near) continue;
        const glm::dvec3 at = viewpoint->project(seen);
        if (!(at.x >= 0 && at.x < frame.width && at.y >= 0 && at.y < frame.height)) continue;
        const double depth = frame.depth[std::size_t(at.y) * std::size_t(frame.width) + std::size_t(at.x)];
        shown += at.z <= depth + std::max(0.01 * depth, 1.5 * p.spacing);
    }
    return double(shown) / double(scene.points.size());
}

/// What makes a picture worth looking at.
double scoreOf(const PictureMeasure& m, double shown, const Candidate& candidate) {
    const double filled = std::min(m.covered / (candidate.view.inside ? 0.95 : 0.5), 1.0);
    const double fill = std::min(std::max(m.fill[0], m.fill[1]) / 0.85, 1.0);
    return 1.2 * filled + 0.6 * fill + 2 * shown + 0.8 * m.readability() + 0.8 * std::min(m.edges, 0.25) +
           0.5 * std::min(m.spread(), 0.6) - 2 * m.near - (candidate.view.inside ? 0 : 3 * m.border) +
           candidate.bonus;
}

class Looker {
  public:
    Looker(const Cloud& cloud, Device& device, const SurveyedScene& scene)
        : cloud_(cloud), device_(device), scene_(scene) {}

    /// Errors: those of drawing.
    Expected<Frame> see(const Camera& camera, const Style& style, int scale = 1) {
        View view;
        view.width = scale * width;
        view.height = scale * height;
        view.camera = camera;
        view.style = style;
        view.quality.samples = 1;
        view.quality.budget = mostSamplesDrawn;
        return render(device_, cloud_, view);
    }

    Expected<std::vector<Scored>> score(const std::vector<Candidate>& candidates, const Style& style) {
        std::vector<Scored> scored;
        for (const Candidate& candidate : candidates) {
            auto frame = see(candidate.view.camera, style);
            if (!frame) return passOn(frame);
            View view;
            view.width = width;
            view.height = height;
            view.camera = candidate.view.camera;
            Scored& s = scored.emplace_back(Scored{candidate.view, 0, measure(*frame)});
            s.score = scoreOf(s.measure, shownShare(scene_, cloud_, view, *frame), candidate);
        }
        std::ranges::stable_sort(scored, std::greater(), &Scored::score);
        return scored;
    }

    /// The first style that can be read from there and is no noisier than the plainest. If there is none: the first
    /// with contrast, for no light gives a smooth wall edges; else the most readable.
    Expected<const StyleChoice*> choose(const std::vector<StyleChoice>& styles, const Camera& camera) {
        const StyleChoice* best = nullptr;
        double value = -1, quiet = 0;
        for (const StyleChoice& choice : styles) {
            const auto frame = see(camera, choice.style, styleScale);
            if (!frame) return passOn(frame);
            const PictureMeasure m = measure(*frame);
            if (&choice == &styles.front()) quiet = m.noise;
            const bool noisy = choice.style.color == ColorSource::Rgb && m.noise > quiet + noiseByLight;
            if (m.isReadable() && !noisy) return &choice;
            const double own = m.readability() + (m.hasContrast() ? 1 : 0) - (noisy ? 1 : 0);
            if (own <= value || (best && value >= 1)) continue;
            value = own;
            best = &choice;
        }
        return best;
    }

  private:
    const Cloud& cloud_;
    Device& device_;
    const SurveyedScene& scene_;
};

/// The best of each name, at most Look::mostViews, "top" among them.
std::vector<LookView> bestViews(const std::vector<Scored>& scored) {
    std::vector<LookView> views;
    std::set<std::string> names;
    for (const Scored& s : scored)
        if (names.insert(s.view.name).second) views.push_back(s.view);
    const auto top = std::ranges::find(views, "top", &LookView::name);
    if (top != views.end() && top - views.begin() >= std::ptrdiff_t(Look::mostViews))
        std::iter_swap(top, views.begin() + Look::mostViews - 1);
    if (views.size() > Look::mostViews) views.resize(Look::mostViews);
    return views;
}

Expected<Look> lookAt(const Cloud& cloud, Device& device, SurveyedScene scene) {
    Look look;
    look.kind = scene.kind;
    look.up = scene.up;
    look.bounds = scene.box;
    look.outline = outlineOf(scene.points);
    look.noise = noiseOf(cloud);
    auto styles = stylesFor(cloud, scene);
    Cloud upright(cloud);  // light needs to know the way up
    upright.look.emplace().up = scene.up;
    Looker looker(upright, device, scene);
    auto candidates = insideCandidates(scene);
    for (Candidate& candidate : outsideCandidates(scene, look.outline))
        candidates.push_back(std::move(candidate));
    const auto scored = looker.score(candidates, styles.front().style);
    if (!scored) return passOn(scored);
    look.views = bestViews(*scored);
    for (StyleChoice& choice : styles)
        if (choice.sidelit) choice.style.light = sidelight(look.views.front().camera, scene.up);
    const auto style = looker.choose(styles, look.views.front().camera);
    if (!style) return passOn(style);
    look.style = (*style)->style;
    look.reason = scene.reason + (*style)->reason +
                  fmt::format(" First seen {}: of {} views tried, it shows most.", look.views.front().name,
                              candidates.size());
    return look;
}

}  // namespace

Expected<Look> decideLook(const Cloud& cloud) {
    auto points = survey(cloud, surveyPoints);
    if (points.empty()) return fail(ErrorCode::Empty, "The cloud has no points to look at.");
    auto device = createDevice({.backend = "cpu"});
    if (!device) return passOn(device);
    return lookAt(cloud, **device, sceneOf(cloud, std::move(points)));
}

std::shared_ptr<const Cloud> withLook(std::shared_ptr<const Cloud> cloud) {
    if (cloud->look) return cloud;
    auto look = decideLook(*cloud);
    if (!look) return cloud;
    auto with = std::make_shared<Cloud>(*cloud);
    with->look = std::move(*look);
    return with;
}

}  // namespace scancast
