#include "renderer/together/together_facts.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "renderer/cloud/columns/color_sources.hpp"
#include "renderer/cloud/columns/column_choice.hpp"

namespace scancast {
namespace {

using Members = std::vector<const TogetherMember*>;
using Box = std::array<glm::dvec3, 2>;

Box moved(Box box, const glm::dvec3& by) {
    return {box[0] + by, box[1] + by};
}

/// One that is NaN or infinite, which no cloud's is, would stay alone.
Box around(const Box& a, const Box& b) {
    return {glm::min(a[0], b[0]), glm::max(a[1], b[1])};
}

template <class T>
std::array<T, 2> aroundRange(const std::array<T, 2>& a, const std::array<T, 2>& b) {
    return {std::min(a[0], b[0]), std::max(a[1], b[1])};
}

/// 0, 0 says that there are none.
std::array<double, 2> aroundKnown(const std::array<double, 2>& a, const std::array<double, 2>& b) {
    constexpr std::array<double, 2> none{0, 0};
    return a == none ? b : b == none ? a : aroundRange(a, b);
}

Box boundsOf(const TogetherMember& member) {
    return moved(member.cloud->bounds, member.shift);
}

/// Without stray points, where that is known.
Box seenBoundsOf(const TogetherMember& member) {
    return moved(member.cloud->look ? member.cloud->look->bounds : member.cloud->bounds, member.shift);
}

template <class Of>
Box boxAround(const Members& members, Of of) {
    Box all = of(*members.front());
    for (const TogetherMember* member : members) all = around(all, of(*member));
    return all;
}

std::optional<UsualRanges> usualTogether(const Members& members) {
    std::optional<UsualRanges> all;
    for (const TogetherMember* member : members) {
        if (!member->cloud->usual) return std::nullopt;
        UsualRanges theirs = *member->cloud->usual;
        theirs.position = moved(theirs.position, member->shift);
        if (!all) {
            all = theirs;
            continue;
        }
        all->position = around(all->position, theirs.position);
        all->intensity = aroundKnown(all->intensity, theirs.intensity);
        all->curvature = aroundKnown(all->curvature, theirs.curvature);
        if (!(all->brightness[1] > 0)) all->brightness = theirs.brightness;
    }
    return all;
}

/// From all corners, so that every camera that is fitted to these sees all of the clouds.
void lookAtAll(Look& look, const Members& members) {
    look.bounds = boxAround(members, seenBoundsOf);
    look.outline.clear();
    for (const TogetherMember* member : members) {
        const Box box = seenBoundsOf(*member);
        for (unsigned corner = 0; corner < 8; ++corner)
            look.outline.emplace_back(box[corner & 1].x, box[corner >> 1 & 1].y, box[corner >> 2 & 1].z);
    }
}

/// What the own cloud's look says of colour and light, as far as all that is shown have what that takes.
void leaveOutWhatIsNotThere(const CloudFacts& shown, Style& style) {
    const bool hasColumn = std::ranges::any_of(
        shown.columns, [&](const KeptColumn& kept) { return kept.column.name == style.column; });
    if (!canColorBy(shown, style.color) || (style.color == ColorSource::Column && !hasColumn)) {
        style.color = ColorSource::Auto;
        style.column.clear();
        style.range.reset();
    }
    if (!canColorBy(shown, ColorSource::Intensity)) style.byIntensity = false;
    if (style.shading == Shading::Phong && !shown.surfels && !shown.attributes.normal) style.shading.reset();
}

/// The own cloud's, but for what it says of places: from outside, where it has such a view.
std::optional<Look> lookTogether(const Together& together, const Members& shown, const Cloud& all) {
    const Cloud& own = *together.members.front().cloud;
    if (!own.look || shown.empty()) return own.look;
    Look look = *own.look;
    lookAtAll(look, shown);
    const auto outside = std::ranges::find(look.views, false, &LookView::inside);
    const Camera camera = outside != look.views.end() ? outside->camera : all.defaultCamera(16.0 / 9);
    look.views = {LookView{"together", false, camera}};
    // A tint is to be seen: who colours by anything else says so.
    const bool tinted =
        std::ranges::any_of(shown, [](const auto* member) { return member->tint.has_value(); });
    const bool ofColors = look.style.color == ColorSource::Rgb || look.style.color == ColorSource::Auto;
    if (tinted && !ofColors) {
        look.style.color = ColorSource::Rgb;
        look.style.byIntensity = false;
        look.style.range.reset();
    }
    leaveOutWhatIsNotThere(all, look.style);
    return look;
}

/// Those that all have, over the values of all.
void addColumns(const Members& shown, CloudFacts& facts) {
    facts.columns.clear();
    for (const std::size_t c : choosableColumns(*shown.front()->cloud)) {
        KeptColumn column = shown.front()->cloud->columns[c];
        column.histogram.reset();
        const bool all = std::ranges::all_of(shown, [&](const TogetherMember* member) {
            for (const std::size_t other : choosableColumns(*member->cloud)) {
                const KeptColumn& theirs = member->cloud->columns[other];
                if (theirs.column.name != column.column.name) continue;
                column.range = aroundRange(column.range, theirs.range);
                if (!theirs.usual) column.usual.reset();
                if (column.usual) column.usual = aroundRange(*column.usual, *theirs.usual);
                return true;
            }
            return false;
        });
        if (all) facts.columns.push_back(std::move(column));
    }
}

void addAttributes(const Together& together, const Members& shown, CloudFacts& facts) {
    const auto all = [&](auto has) { return std::ranges::all_of(shown, has); };
    const auto any = [&](auto has) { return std::ranges::any_of(shown, has); };
    Attributes& attributes = facts.attributes;
    attributes = {};
    attributes.color = together.byCloud || any([](const auto* m) { return m->tint || hasColors(*m->cloud); });
    attributes.intensity =
        any([](const auto* m) { return m->cloud->attributes.intensity || m->cloud->constant.intensity; });
    attributes.classification = any([](const auto* m) { return m->cloud->attributes.classification; });
    attributes.normal = all([](const auto* m) { return m->cloud->attributes.normal; });
    facts.constant = {};
    facts.companions.clear();
    attributes.nearInfrared = all([](const auto* m) { return hasNearInfrared(*m->cloud); });
    if (all([](const auto* m) { return hasCurvature(*m->cloud); }))
        facts.companions.push_back(curvaturePlane());
    if (attributes.nearInfrared) facts.companions.push_back(nearInfraredPlane());
    facts.surfels = all([](const auto* m) { return m->cloud->surfels; });
    facts.oriented = all([](const auto* m) { return m->cloud->oriented; });
    facts.sides.reset();
    for (const TogetherMember* member : shown) {
        const auto& sides = member->cloud->sides;
        if (!facts.sides && (sides || member->cloud->oriented)) facts.sides = sides.value_or(KnownSides());
    }
}

void addRanges(const Members& shown, CloudFacts& facts) {
    facts.bounds = boxAround(shown, boundsOf);
    facts.points = facts.droppedPoints = 0;
    facts.classCounts = {};
    facts.spacing = 0;
    facts.mirrors.clear();
    std::optional<std::array<std::uint16_t, 2>> intensity;
    for (const TogetherMember* member : shown) {
        const Cloud& cloud = *member->cloud;
        facts.points += cloud.points;
        facts.droppedPoints += cloud.droppedPoints;
        for (std::size_t i = 0; i < facts.classCounts.size(); ++i)
            facts.classCounts[i] += cloud.classCounts[i];
        facts.spacing = std::max(facts.spacing, cloud.spacing);
        if (cloud.attributes.intensity || cloud.constant.intensity)
            intensity = intensity ? aroundRange(*intensity, cloud.intensityRange) : cloud.intensityRange;
        for (Mirror mirror : cloud.mirrors) {
            mirror.center += member->shift;
            facts.mirrors.push_back(mirror);
        }
    }
    if (intensity) facts.intensityRange = *intensity;
    facts.usual = usualTogether(shown);
}

/// Photos and stations stand where their cloud does.
void moveWithOwn(const glm::dvec3& by, CloudFacts& facts) {
    if (facts.scanner) *facts.scanner += by;
    for (Station& station : facts.stations) station.position += by;
    for (Photo& photo : facts.photos)
        if (photo.pose) photo.pose->position += by;
}

std::string revisionOf(const Together& together) {
    std::string all = together.byCloud ? "by cloud" : "";
    for (std::size_t i = 0; i < together.members.size(); ++i) {
        const TogetherMember& member = together.members[i];
        all += fmt::format("\n{} {:a} {:a} {:a} {}", member.cloud->revision, member.shift.x, member.shift.y,
                           member.shift.z, member.hidden);
        if (const auto& paint = together.paints[i])
            all +=
                fmt::format(" {} {} {} {}", paint->color[0], paint->color[1], paint->color[2], paint->covers);
    }
    const XXH128_hash_t hash = XXH3_128bits(all.data(), all.size());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

bool hasColors(const CloudFacts& facts) {
    return facts.attributes.color || facts.constant.color;
}

CloudFacts factsTogether(const Together& together) {
    const TogetherMember& own = together.members.front();
    Members shown;
    for (const TogetherMember& member : together.members)
        if (!member.hidden && !member.cloud->octree.nodes().empty()) shown.push_back(&member);
    Cloud all;  // without nodes: what cameras are fitted to
    CloudFacts& facts = all;
    facts = *own.cloud;
    facts.columns.clear();
    facts.grid.reset();
    facts.exact = false;
    moveWithOwn(own.shift, facts);
    if (!shown.empty()) {
        addAttributes(together, shown, facts);
        addRanges(shown, facts);
        addColumns(shown, facts);
    } else {
        facts.bounds = boundsOf(own);
        facts.points = 0;
        facts.mirrors.clear();
    }
    facts.look = lookTogether(together, shown, all);
    facts.revision = revisionOf(together);
    return facts;
}

}  // namespace scancast
