#include "renderer/cloud/export/survey_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "renderer/cloud/file/exact_places.hpp"

namespace scancast {
namespace {

constexpr std::size_t leavesAtOnce = 16;

/// Where a whole leaf's points are at most: exactly, where samples say positions.
std::array<glm::dvec3, 2> outerBounds(const CloudFile& file, const Node& node) {
    const CloudFacts& facts = file.facts();
    if (roundsPositions(node, facts.grid)) return reachOf(file, node);
    std::array<glm::dvec3, 2> bounds{facts.origin + node.boxMin, facts.origin + node.boxMax};
    for (glm::dvec3& corner : bounds)
        corner = facts.grid->origin +
                 glm::round((corner - facts.grid->origin) / facts.grid->step) * facts.grid->step;
    return bounds;
}

std::optional<std::size_t> returnsPlane(const CloudFile& file) {
    const auto planes = file.planes();
    const auto found = std::ranges::find_if(planes, [](const ValuePlane& plane) {
        return plane.name == "return_number" && plane.type == ColumnType::Uint8;
    });
    if (found == planes.end()) return std::nullopt;
    return std::size_t(found - planes.begin());
}

}  // namespace

SurveyAhead::SurveyAhead(std::shared_ptr<const CloudFile> file, const CloudPointsOptions& options,
                         ExportFormat format)
    : file_(std::move(file)), options_(options), isLas_(format == ExportFormat::Las) {
    const CloudFacts& facts = file_->facts();
    survey_.highestClass = 0;
    for (unsigned c = 0; c < facts.classCounts.size(); ++c)
        if (facts.classCounts[c] > 0) survey_.highestClass = std::uint8_t(c);
    if (isLas_) returns_ = returnsPlane(*file_);
    options_.columns = returns_.has_value();
    options_.estimatedNormals = false;
    std::vector<WantedLeaf> partly;
    for (const WantedLeaf& leaf : wantedLeaves(*file_, options_))
        (leaf.whole ? whole_ : partly).push_back(leaf);
    for (const WantedLeaf& leaf : whole_) survey_.points += file_->nodes()[leaf.node].node.sampleCount;
    if (!returns_) survey_.returns[0] = survey_.points;
    if (!partly.empty()) partly_ = cloudPoints(file_, options_, std::move(partly));
    // What is not asked for need not be looked for.
    if (!isLas_) whole_.clear();
    if (!returns_) counted_ = whole_.size();
}

Expected<bool> SurveyAhead::step() {
    if (options_.stop.stop_requested())
        return fail(ErrorCode::Cancelled, "Nobody waits for these points any more.");
    if (partly_) return readPartly();
    if (counted_ < whole_.size()) return countReturns();
    return findBounds();
}

Expected<bool> SurveyAhead::readPartly() {
    PointBatch batch;
    auto more = partly_->read(batch);
    if (!more) return passOn(more);
    if (*more)
        survey_.add(batch, partly_->header());
    else
        partly_.reset();
    return true;
}

Expected<bool> SurveyAhead::countReturns() {
    const std::size_t end = std::min(whole_.size(), counted_ + leavesAtOnce);
    for (; counted_ < end && !options_.stop.stop_requested(); ++counted_) {
        const auto values = file_->plane(whole_[counted_].node, *returns_);
        if (!values) return passOn(values);
        for (const std::byte value : *values) {
            const auto number = std::to_integer<unsigned>(value);
            if (number >= 1 && number <= survey_.returns.size()) ++survey_.returns[number - 1];
        }
    }
    return true;
}

void SurveyAhead::orderBySides() {
    read_.assign(whole_.size(), false);
    for (int axis = 0; axis < 3; ++axis)
        for (const bool upper : {false, true}) sides_.push_back({axis, upper, {}, 0});
    for (std::uint32_t i = 0; i < whole_.size(); ++i) {
        const auto bounds = outerBounds(*file_, file_->nodes()[whole_[i].node].node);
        for (Side& side : sides_) side.reach.emplace_back(bounds[side.upper ? 1 : 0][side.axis], i);
    }
    for (Side& side : sides_) {
        std::ranges::sort(side.reach);
        if (side.upper) std::ranges::reverse(side.reach);
    }
}

// Side by side, those that may lie outermost first, until the next one cannot.
Expected<bool> SurveyAhead::findBounds() {
    if (whole_.empty()) return false;
    if (sides_.empty()) orderBySides();
    for (Side& side : sides_)
        for (; side.next < side.reach.size(); ++side.next) {
            const auto& [reach, leaf] = side.reach[side.next];
            const bool beyond = side.upper ? reach > survey_.high[side.axis] : reach < survey_.low[side.axis];
            if (!beyond) break;
            if (read_[leaf]) continue;
            read_[leaf] = true;
            if (auto ok = readBounds(whole_[leaf]); !ok) return passOn(ok);
            return true;
        }
    return false;
}

Expected<void> SurveyAhead::readBounds(const WantedLeaf& leaf) {
    CloudPointsOptions all = options_;
    all.columns = false;
    const auto source = cloudPoints(file_, all, {leaf});
    PointBatch batch;
    for (;;) {
        auto more = source->read(batch);
        if (!more) return passOn(more);
        if (!*more) return {};
        for (const glm::dvec3& p : batch.position) {
            survey_.low = glm::min(survey_.low, p);
            survey_.high = glm::max(survey_.high, p);
        }
    }
}

}  // namespace scancast
