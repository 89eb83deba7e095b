#include "renderer/cloud/export/decoded_leaf.hpp"

#include <algorithm>

#include "files/bytes.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"

namespace scancast {

LeafDecoder::LeafDecoder(std::shared_ptr<const CloudFile> file, const CloudPointsOptions& options)
    : file_(std::move(file)),
      places_(file_->facts(), file_.get()),
      region_(options.region),
      corridor_(options.corridor) {
    const CloudFacts& facts = file_->facts();
    std::vector<Column> all;
    for (const KeptColumn& kept : facts.columns) {
        all.push_back(kept.column);
        types_.push_back(kept.column.type);
    }
    if (facts.exact) positions_ = findColumns(all, exactPositionNames, ColumnType::Float64);
    if (facts.exact) normals_ = findColumns(all, exactNormalNames, ColumnType::Float32);
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
    leaf.places.resize(leaf.samples.size());
    // They are at hand: planes would be read once more.
    if (positions_ && !leaf.rows.empty()) return placeByRows(leaf), Expected<void>();
    return places_.of(index, file_->nodes()[index].node, leaf.samples, leaf.places);
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
