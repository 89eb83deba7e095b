#include "renderer/cloud/export/decoded_leaf.hpp"

#include <algorithm>
#include <glm/common.hpp>

#include "files/bytes.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/export/on_grid.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"

namespace scancast {

LeafDecoder::LeafDecoder(std::shared_ptr<const CloudFile> file, const CloudPointsOptions& options)
    : file_(std::move(file)), region_(options.region), corridor_(options.corridor) {
    const CloudFacts& facts = file_->facts();
    std::vector<Column> all;
    for (const KeptColumn& kept : facts.columns) {
        all.push_back(kept.column);
        types_.push_back(kept.column.type);
    }
    if (facts.exact) positions_ = findColumns(all, exactPositionNames, ColumnType::Float64);
    if (facts.exact) normals_ = findColumns(all, exactNormalNames, ColumnType::Float32);
    if (!facts.grid || !hasGridPlanes(facts)) return;
    const auto wanted = gridPlanes();
    gridPlanes_.emplace();
    for (std::size_t a = 0; a < 3; ++a)
        (*gridPlanes_)[a] =
            std::size_t(std::ranges::find(file_->planes(), wanted[a]) - file_->planes().begin());
}

Expected<DecodedLeaf> LeafDecoder::decode(const WantedLeaf& wanted, bool wantsRows) const {
    DecodedLeaf leaf;
    auto samples = file_->samples(wanted.node);
    if (!samples) return passOn(samples);
    leaf.samples = std::move(*samples);
    leaf.whole = wanted.whole;
    const auto readRows = [&]() -> Expected<void> {
        if (types_.empty() || !leaf.rows.empty()) return {};
        auto rows = file_->rows(wanted.node);
        if (!rows) return passOn(rows);
        leaf.rows = std::move(*rows);
        return {};
    };
    if (!leaf.whole && region_ && region_->hasClasses() &&
        std::ranges::none_of(leaf.samples, [&](const Sample& s) { return region_->takes(s.classification); }))
        return leaf;
    if (positions_)
        if (auto ok = readRows(); !ok) return passOn(ok);
    if (auto ok = placePoints(wanted.node, leaf); !ok) return passOn(ok);
    if (!leaf.whole) keepWanted(wanted.node, leaf);
    if ((wantsRows || normals_) && leaf.size() > 0)
        if (auto ok = readRows(); !ok) return passOn(ok);
    return leaf;
}

Expected<void> LeafDecoder::placePoints(std::uint32_t index, DecodedLeaf& leaf) const {
    const Node& node = file_->nodes()[index].node;
    const CloudFacts& facts = file_->facts();
    leaf.places.resize(leaf.samples.size());
    if (positions_ && !leaf.rows.empty()) return placeByRows(leaf), Expected<void>();
    if (gridPlanes_ && rounds(node, facts.grid)) return placeByPlanes(index, leaf);
    if (facts.grid && !rounds(node, facts.grid)) {
        // On the grid: the very numbers that the scan's reader had.
        const glm::dvec3 start = (facts.origin + node.boxMin - facts.grid->origin) / facts.grid->step;
        const glm::dvec3 step = node.step / facts.grid->step;
        for (std::size_t i = 0; i < leaf.samples.size(); ++i) {
            const Sample& s = leaf.samples[i];
            const glm::dvec3 q = glm::round(start + step * glm::dvec3(s.x, s.y, s.z));
            leaf.places[i] = facts.grid->origin + q * facts.grid->step;
        }
        return {};
    }
    for (std::size_t i = 0; i < leaf.samples.size(); ++i)
        leaf.places[i] = facts.origin + position(node, leaf.samples[i]);
    return {};
}

Expected<void> LeafDecoder::placeByPlanes(std::uint32_t index, DecodedLeaf& leaf) const {
    const ScanGrid& grid = *file_->facts().grid;
    for (int a = 0; a < 3; ++a) {
        const auto values = file_->plane(index, (*gridPlanes_)[std::size_t(a)]);
        if (!values) return passOn(values);
        if (values->size() != leaf.samples.size() * sizeof(std::int32_t))
            return fail(ErrorCode::Malformed, file_->path().string() +
                                                  " has no positions beside the samples "
                                                  "of a node that rounds them; the file is damaged");
        for (std::size_t i = 0; i < leaf.samples.size(); ++i)
            leaf.places[i][a] =
                grid.origin[a] +
                double(loadLe<std::int32_t>(values->data() + i * sizeof(std::int32_t))) * grid.step[a];
    }
    return {};
}

void LeafDecoder::placeByRows(DecodedLeaf& leaf) const {
    const auto places = placesInRow(types_);
    const std::size_t stride = places.front().rowBytes;
    for (std::size_t i = 0; i < leaf.samples.size(); ++i)
        for (int a = 0; a < 3; ++a)
            leaf.places[i][a] =
                loadLe<double>(leaf.rows.data() + i * stride + places[(*positions_)[std::size_t(a)]].offset);
}

void LeafDecoder::keepWanted(std::uint32_t index, DecodedLeaf& leaf) const {
    std::vector<std::uint32_t> segments;
    if (corridor_) {
        const auto reach = reachOf(*file_, file_->nodes()[index].node);
        segments = corridor_->segmentsNear(glm::dvec2(reach[0]), glm::dvec2(reach[1]));
    }
    for (std::uint32_t i = 0; i < leaf.samples.size(); ++i) {
        const glm::dvec3& p = leaf.places[i];
        if (region_ && (!region_->takes(leaf.samples[i].classification) || !region_->contains(p))) continue;
        if (corridor_) {
            const auto place = corridor_->place(glm::dvec2(p), segments);
            if (!place) continue;
            leaf.along.push_back(*place);
        }
        leaf.kept.push_back(i);
    }
}

}  // namespace scancast
