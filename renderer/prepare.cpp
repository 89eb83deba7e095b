#include "renderer/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/image/clock.hpp"
#include "renderer/mirrors.hpp"
#include "renderer/residency/provide.hpp"

namespace scancast {
namespace {

Expected<void> checkBruteForce(const Cloud& cloud, const Octree& octree) {
    const auto most = mostSamples(octree);
    if (!most || cloud.points <= *most) return {};
    return fail(ErrorCode::ResourceLimit,
                fmt::format("every point of this cloud does not fit the memory limit: it has {}, and {} fit; "
                            "raise the limit, or draw without --brute-force",
                            cloud.points, *most));
}

SelectOptions selectionWith(const RenderOptions& options, bool beside, SelectOptions selection) {
    selection.bruteForce = options.bruteForce;
    if (options.wait || !options.mostSamples) return selection;
    // What stands beside four samples takes as much of a device's memory as a sample.
    const std::uint64_t most = beside ? *options.mostSamples / 5 * 4 : *options.mostSamples;
    selection.budget = std::min(selection.budget.value_or(most), most);
    return selection;
}

/// Chooses the runs of all cuts; returns how the main view's were chosen.
SelectOptions selectCuts(const Octree& octree, SelectOptions selection, std::vector<CutView>& cuts) {
    const auto budget = selection.budget;
    std::vector<std::uint64_t> shares;
    if (budget) shares = shareBudget(*budget, cuts);
    std::uint64_t used = 0;
    // The coarsest cut of a reflection may exceed its share: then the main view, chosen last, gets less.
    for (std::size_t i = cuts.size(); i-- > 0;) {
        CutView& view = cuts[i];
        if (budget) selection.budget = i > 0 ? shares[i] : *budget - std::min(used, *budget - 1);
        view.cut = select(octree, view.viewpoint, selectionOf(view, selection));
        used += view.cut.samples;
    }
    return selection;
}

/// The runs that a picture from `camera` would draw; none where no such picture can be made.
Cut cutAhead(const Cloud& cloud, const Octree& octree, View view, const Camera& camera,
             const SelectOptions& selection) {
    view.camera = camera;
    const auto viewpoint = Viewpoint::create(view, cloud.origin, cloud.bounds);
    return viewpoint ? select(octree, *viewpoint, selection) : Cut();
}

std::vector<CutRun> runsOf(std::span<CutView* const> cuts) {
    std::vector<CutRun> runs;
    for (const CutView* view : cuts) runs.insert(runs.end(), view->cut.runs.begin(), view->cut.runs.end());
    return runs;
}

/// The main view, its reflections, the sun's.
std::vector<CutView*> cutsIn(PreparedView& prepared) {
    std::vector<CutView*> all;
    for (CutView& view : prepared.cuts) all.push_back(&view);
    if (prepared.sun) all.push_back(&*prepared.sun);
    return all;
}

/// What the sun sees may take so much of a budget.
constexpr std::uint64_t sunsPart = 4;

/// Chooses what the sun sees; returns what is left of the budget for the others.
SelectOptions selectSun(const Octree& octree, const PlannedView& plan, const RenderOptions& options,
                        SelectOptions selection, PreparedView& prepared) {
    if (!plan.sun) return selection;
    SelectOptions ofSun = selectionWith(options, plan.beside, plan.sunSelection);
    if (ofSun.budget) ofSun.budget = std::max<std::uint64_t>(1, *ofSun.budget / sunsPart);
    prepared.sun = CutView{*plan.sun, select(octree, *plan.sun, ofSun), plan.filter};
    if (selection.budget) *selection.budget -= std::min(*selection.budget - 1, prepared.sun->cut.samples);
    return selection;
}

/// All of them or none, so that a node is the same thing in each.
void askForBeside(std::span<CutView* const> cuts) {
    for (CutView* const view : cuts) view->cut.beside = true;
}

/// The samples of all cuts; what is missing is requested once for all, by the main view.
Expected<void> provideCuts(const Octree& octree, ProvideOptions options, std::span<CutView* const> cuts,
                           const std::stop_token& stop) {
    const std::vector<CutRun> beside = runsOf(cuts.subspan(1));
    options.beside = beside;
    for (CutView* const view : cuts) {
        auto cut = provide(octree, std::move(view->cut), options, stop);
        if (!cut) return passOn(cut);
        view->cut = std::move(*cut);
        options.request = false;
    }
    return {};
}

/// A view whose words have just changed has nothing yet: without its root, which is a few thousand samples, it would blink.
void bringRoot(const PlannedView& planned, const RenderOptions& options, const std::stop_token& stop) {
    if (!planned.pictured || options.wait) return;
    SampleStore& store = planned.pictured->store();
    const auto file = store.cloudFile();
    if (file && !file->isRemote() && !store.damaged(0) && !store.find(0)) (void)store.load(0, stop);
}

}  // namespace

std::vector<CutView> cutsOf(const Cloud& cloud, const PlannedView& planned) {
    std::vector<CutView> cuts;
    if (planned.view.style.mirrors)
        cuts = reflectionsIn(cloud, planned.viewpoint, planned.filter, planned.margin);
    cuts.insert(cuts.begin(), CutView{planned.viewpoint, {}, planned.filter});
    return cuts;
}

std::uint64_t samplesWanted(const Cloud& cloud, const PlannedView& planned) {
    PreparedView wanted;
    wanted.cuts = cutsOf(cloud, planned);
    const Octree& octree = octreeOf(cloud, planned);
    const SelectOptions whole = selectSun(octree, planned, {}, planned.selection, wanted);
    selectCuts(octree, whole, wanted.cuts);
    std::uint64_t samples = 0;
    for (const CutView* view : cutsIn(wanted)) samples += view->cut.samples;
    return samples;
}

Expected<std::shared_ptr<const PreparedView>> prepare(const Cloud& cloud,
                                                      std::shared_ptr<const PlannedView> planned,
                                                      const RenderOptions& options, std::stop_token stop) {
    const Octree& octree = octreeOf(cloud, *planned);
    if (options.bruteForce) {
        if (auto ok = checkBruteForce(cloud, octree); !ok) return passOn(ok);
    }
    auto prepared = std::make_shared<PreparedView>();
    prepared->planned = std::move(planned);
    prepared->cloud = &cloud;
    prepared->depth = options.depth;
    prepared->tileSide = std::max(options.tileSide, 1);

    const PlannedView& plan = *prepared->planned;
    auto start = Clock::now();
    prepared->cuts = cutsOf(cloud, plan);
    const SelectOptions whole =
        selectSun(octree, plan, options, selectionWith(options, plan.beside, plan.selection), *prepared);
    const SelectOptions selection = selectCuts(octree, whole, prepared->cuts);
    Cut soon;
    if (options.ahead && !options.wait && mostSamples(octree))
        soon = cutAhead(cloud, octree, plan.view, *options.ahead, selection);
    prepared->selectMs = millisecondsSince(start);
    start = Clock::now();
    const ProvideOptions provision{.wait = options.wait, .requester = options.requester, .ahead = soon.runs};
    const std::vector<CutView*> all = cutsIn(*prepared);
    if (plan.beside) askForBeside(all);
    bringRoot(plan, options, stop);
    if (auto ok = provideCuts(octree, provision, all, stop); !ok) return passOn(ok);
    prepared->provideMs = millisecondsSince(start);
    return prepared;
}

std::uint64_t samplesMissing(const PreparedView& prepared) {
    std::uint64_t missing = 0;
    for (const CutView& view : prepared.cuts) missing += view.cut.samplesMissing;
    if (prepared.sun) missing += prepared.sun->cut.samplesMissing;
    return missing;
}

}  // namespace scancast
