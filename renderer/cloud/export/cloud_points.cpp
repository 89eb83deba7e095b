#include "renderer/cloud/export/cloud_points.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>

#include "files/bytes.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"

namespace scancast {

namespace {

/// Lattice steps are those of the grid times a power of two, computed in doubles.
constexpr double sameStep = 1 + 1e-9;

bool rounds(const Node& leaf, const std::optional<ScanGrid>& grid) {
    if (!grid) return true;
    for (int a = 0; a < 3; ++a)
        if (leaf.step[a] > grid->step[a] * sameStep) return true;
    return false;
}

/// Leaves that touch the box, depth first, and how many points they have.
std::vector<std::uint32_t> leavesWithin(const CloudFile& file, const std::optional<ClipBox>& clip) {
    std::vector<std::uint32_t> leaves, open{0};
    const glm::dvec3 origin = file.facts().origin;
    while (!open.empty()) {
        const std::uint32_t index = open.back();
        open.pop_back();
        const Node& node = file.nodes()[index].node;
        if (clip) {
            // Positions on the scan's grid may lie a step beside what the samples say.
            const glm::dvec3 margin = node.step + 1e-9 * (glm::abs(node.boxMax) + glm::abs(origin));
            const glm::dvec3 low = origin + node.boxMin - margin, high = origin + node.boxMax + margin;
            bool apart = false;
            for (int a = 0; a < 3; ++a) apart = apart || low[a] > clip->max[a] || high[a] < clip->min[a];
            if (apart) continue;
        }
        if (node.isLeaf()) leaves.push_back(index);
        for (std::uint32_t c = node.childCount; c-- > 0;) open.push_back(node.firstChild + c);
    }
    return leaves;
}

class CloudPoints final : public PointSource {
  public:
    CloudPoints(std::shared_ptr<const CloudFile> file, const CloudPointsOptions& options)
        : file_(std::move(file)), leaves_(leavesWithin(*file_, options.clip)) {
        const CloudFacts& facts = file_->facts();
        header_.format = facts.format;
        header_.attributes = facts.attributes;
        header_.attributes.color |= facts.constant.color.has_value();
        header_.attributes.intensity |= facts.constant.intensity.has_value();
        header_.attributes.nearInfrared = false;  // whole where it is a column
        const bool own = facts.sides && facts.sides->by == KnownSides::By::File;
        header_.attributes.normal &= options.estimatedNormals || own || !facts.surfels;
        if (facts.grid) {
            header_.gridStep = facts.grid->step;
            header_.gridOrigin = facts.grid->origin;
        }
        header_.bounds = facts.bounds;
        header_.crsWkt = facts.crsWkt;
        header_.crsEpsg = facts.crsEpsg;
        header_.scannerOrigin = facts.scanner;
        std::uint64_t points = 0;
        for (const std::uint32_t leaf : leaves_) points += file_->nodes()[leaf].node.sampleCount;
        header_.points = points;
        chooseColumns();
        choosePlanes();
    }

    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }
    std::array<std::uint64_t, 2> bytesRead() const override { return {0, 0}; }

    Expected<bool> read(PointBatch& batch) override {
        if (given_ == held_.size()) {
            if (next_ == leaves_.size()) {
                batch.clear();
                return false;
            }
            if (auto ok = decodeSome(); !ok) return passOn(ok);
        }
        if (given_ == 0 && held_.size() <= batchPoints) {
            std::swap(batch, held_);
            held_.clear();
            return true;
        }
        const std::size_t count = std::min(held_.size() - given_, batchPoints);
        slice(given_, count, batch);
        given_ += count;
        if (given_ < held_.size()) return true;
        held_.clear();
        given_ = 0;
        return true;
    }

  private:
    void chooseColumns() {
        std::vector<Column> all;
        for (const KeptColumn& kept : file_->facts().columns) all.push_back(kept.column);
        const bool exact = file_->facts().exact;
        if (exact) positions_ = findColumns(all, exactPositionNames, ColumnType::Float64);
        if (exact) normals_ = findColumns(all, exactNormalNames, ColumnType::Float32);
        const auto taken = [](const auto& three, std::size_t c) {
            return three && std::ranges::find(*three, c) != three->end();
        };
        for (std::size_t c = 0; c < all.size(); ++c) {
            if (taken(positions_, c) || taken(normals_, c)) continue;
            kept_.push_back(c);
            header_.columns.push_back(all[c]);
        }
        stride_ = rowBytes(header_.columns);
    }

    void choosePlanes() {
        if (!file_->facts().grid || !hasGridPlanes(file_->facts())) return;
        const auto wanted = gridPlanes();
        gridPlanes_.emplace();
        for (std::size_t a = 0; a < 3; ++a)
            (*gridPlanes_)[a] =
                std::size_t(std::ranges::find(file_->planes(), wanted[a]) - file_->planes().begin());
    }

    /// Some leaves, side by side.
    Expected<void> decodeSome() {
        std::vector<std::uint32_t> some;
        std::vector<std::size_t> first{0};
        while (next_ < leaves_.size()) {
            const std::size_t more = file_->nodes()[leaves_[next_]].node.sampleCount;
            if (!some.empty() && first.back() + more > batchPoints) break;
            some.push_back(leaves_[next_++]);
            first.push_back(first.back() + more);
        }
        const std::size_t count = first.back();
        places_.resize(count);
        held_.color.resize(header_.attributes.color ? count : 0);
        held_.intensity.resize(header_.attributes.intensity ? count : 0);
        held_.classification.resize(header_.attributes.classification ? count : 0);
        held_.normal.resize(header_.attributes.normal ? count : 0);
        held_.rows.resize(count * stride_);
        given_ = 0;
        std::vector<Expected<void>> done(some.size());
        tbb::parallel_for(std::size_t(0), some.size(),
                          [&](std::size_t i) { done[i] = decodeLeaf(some[i], first[i]); });
        for (auto& one : done)
            if (!one) return one;
        held_.position = std::move(places_);
        places_ = {};
        return {};
    }

    Expected<void> decodeLeaf(std::uint32_t index, std::size_t first) {
        const auto samples = file_->samples(index);
        if (!samples) return passOn(samples);
        for (std::size_t i = 0; i < samples->size(); ++i) {
            const Sample& s = (*samples)[i];
            if (!held_.color.empty()) held_.color[first + i] = {s.r, s.g, s.b};
            if (!held_.intensity.empty()) held_.intensity[first + i] = s.intensity;
            if (!held_.classification.empty()) held_.classification[first + i] = s.classification;
            if (!held_.normal.empty()) held_.normal[first + i] = decodeNormal(s.normal);
        }
        auto rows = file_->rows(index);
        if (!rows) return passOn(rows);
        if (auto ok = placePoints(index, *samples, first); !ok) return ok;
        takeRows(*rows, samples->size(), first);
        return {};
    }

    Expected<void> placePoints(std::uint32_t index, std::span<const Sample> samples, std::size_t first) {
        const Node& node = file_->nodes()[index].node;
        const CloudFacts& facts = file_->facts();
        if (gridPlanes_ && rounds(node, facts.grid)) return placeByPlanes(index, samples.size(), first);
        if (facts.grid && !rounds(node, facts.grid)) {
            // On the grid: the very numbers that the scan's reader had.
            const glm::dvec3 start = (facts.origin + node.boxMin - facts.grid->origin) / facts.grid->step;
            const glm::dvec3 step = node.step / facts.grid->step;
            for (std::size_t i = 0; i < samples.size(); ++i) {
                const Sample& s = samples[i];
                const glm::dvec3 q = glm::round(start + step * glm::dvec3(s.x, s.y, s.z));
                places_[first + i] = facts.grid->origin + q * facts.grid->step;
            }
            return {};
        }
        for (std::size_t i = 0; i < samples.size(); ++i)
            places_[first + i] = facts.origin + position(node, samples[i]);
        return {};
    }

    Expected<void> placeByPlanes(std::uint32_t index, std::size_t count, std::size_t first) {
        const ScanGrid& grid = *file_->facts().grid;
        for (int a = 0; a < 3; ++a) {
            const auto values = file_->plane(index, (*gridPlanes_)[std::size_t(a)]);
            if (!values) return passOn(values);
            if (values->size() != count * sizeof(std::int32_t))
                return fail(ErrorCode::Malformed, file_->path().string() +
                                                      " has no positions beside the samples "
                                                      "of a node that rounds them; the file is damaged");
            for (std::size_t i = 0; i < count; ++i)
                places_[first + i][a] =
                    grid.origin[a] +
                    double(loadLe<std::int32_t>(values->data() + i * sizeof(std::int32_t))) * grid.step[a];
        }
        return {};
    }

    /// The columns that are columns; positions and normals come out of the others.
    void takeRows(std::span<const std::byte> rows, std::size_t count, std::size_t first) {
        if (rows.empty()) return;
        std::vector<ColumnType> types;
        for (const KeptColumn& kept : file_->facts().columns) types.push_back(kept.column.type);
        const auto places = placesInRow(types);
        const std::size_t from = places.front().rowBytes;
        if (kept_.size() == places.size()) {
            std::memcpy(held_.rows.data() + first * stride_, rows.data(), count * stride_);
            return;
        }
        for (std::size_t i = 0; i < count; ++i) {
            const std::byte* row = rows.data() + i * from;
            std::byte* to = held_.rows.data() + (first + i) * stride_;
            for (const std::size_t c : kept_) {
                std::memcpy(to, row + places[c].offset, places[c].bytes);
                to += places[c].bytes;
            }
            for (int a = 0; a < 3; ++a) {
                if (positions_)
                    places_[first + i][a] =
                        loadLe<double>(row + places[(*positions_)[std::size_t(a)]].offset);
                if (normals_ && !held_.normal.empty())
                    held_.normal[first + i][a] =
                        loadLe<float>(row + places[(*normals_)[std::size_t(a)]].offset);
            }
        }
    }

    void slice(std::size_t first, std::size_t count, PointBatch& batch) const {
        const auto part = [&](const auto& from) {
            using Values = std::remove_cvref_t<decltype(from)>;
            if (from.empty()) return Values();
            const auto begin = from.begin() + std::ptrdiff_t(first);
            return Values(begin, begin + std::ptrdiff_t(count));
        };
        const auto place = held_.position.begin() + std::ptrdiff_t(first);
        batch.position = std::vector<glm::dvec3>(place, place + std::ptrdiff_t(count));
        batch.color = part(held_.color);
        batch.intensity = part(held_.intensity);
        batch.classification = part(held_.classification);
        batch.normal = part(held_.normal);
        const auto rows = held_.rows.begin() + std::ptrdiff_t(first * stride_);
        batch.rows.assign(rows, rows + std::ptrdiff_t(count * stride_));
    }

    std::shared_ptr<const CloudFile> file_;
    std::vector<std::uint32_t> leaves_;
    std::size_t next_ = 0;
    ScanHeader header_;
    std::optional<std::array<std::size_t, 3>> positions_, normals_;  ///< among the file's columns
    std::optional<std::array<std::size_t, 3>> gridPlanes_;           ///< among the file's planes
    std::vector<std::size_t> kept_;                                  ///< the other columns
    std::size_t stride_ = 0;
    std::vector<glm::dvec3> places_;  ///< of what is being decoded
    PointBatch held_;                 ///< decoded, and given away as far as given_
    std::size_t given_ = 0;
};

}  // namespace

std::unique_ptr<PointSource> cloudPoints(std::shared_ptr<const CloudFile> file,
                                         const CloudPointsOptions& options) {
    return std::make_unique<CloudPoints>(std::move(file), options);
}

RoundedPoints roundedPoints(const CloudFile& file, const std::optional<ClipBox>& clip) {
    const CloudFacts& facts = file.facts();
    RoundedPoints rounded;
    if (facts.exact) return rounded;
    for (const std::uint32_t leaf : leavesWithin(file, clip)) {
        const Node& node = file.nodes()[leaf].node;
        if (!rounds(node, facts.grid)) continue;
        rounded.points += node.sampleCount;
        for (int a = 0; a < 3; ++a)
            if (!facts.grid || node.step[a] > facts.grid->step[a] * sameStep)
                rounded.most[a] = std::max(rounded.most[a], node.step[a] / 2);
    }
    return rounded;
}

}  // namespace scancast
