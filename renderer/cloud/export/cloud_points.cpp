#include "renderer/cloud/export/cloud_points.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

#include "files/bytes.hpp"
#include "renderer/cloud/export/decoded_leaf.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"

namespace scancast {

namespace {

Expected<DecodedLeaf> abandoned() {
    return fail(ErrorCode::Cancelled, "Nobody waits for these points any more.");
}

class CloudPoints final : public PointSource {
  public:
    CloudPoints(std::shared_ptr<const CloudFile> file, const CloudPointsOptions& options,
                std::vector<WantedLeaf> leaves)
        : decoder_(file, options), file_(std::move(file)), leaves_(std::move(leaves)), options_(options) {
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
        if (!options.region && !options.corridor) header_.bounds = facts.bounds;
        header_.crsWkt = facts.crsWkt;
        header_.crsEpsg = facts.crsEpsg;
        header_.scannerOrigin = facts.scanner;
        const bool known = std::ranges::all_of(leaves_, [](const WantedLeaf& leaf) { return leaf.whole; });
        if (known) header_.points = 0;
        for (const WantedLeaf& leaf : leaves_)
            if (known) *header_.points += file_->nodes()[leaf.node].node.sampleCount;
        chooseColumns();
    }

    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }
    std::array<std::uint64_t, 2> bytesRead() const override { return {0, 0}; }

    Expected<bool> read(PointBatch& batch) override {
        if (given_ == held_.size()) {
            held_.clear();
            given_ = 0;
            if (options_.stop.stop_requested()) return passOn(abandoned());
            if (next_ == leaves_.size()) {
                batch.clear();
                return false;
            }
            if (auto ok = decodeSome(); !ok) return passOn(ok);
        }
        // Of leaves that have none of the points wanted: who asks decides whether to go on.
        if (held_.size() == 0) {
            batch.clear();
            return true;
        }
        if (given_ == 0 && held_.size() <= batchPoints) {
            std::swap(batch, held_);
            held_.clear();
            return true;
        }
        const std::size_t count = std::min(held_.size() - given_, batchPoints);
        slice(given_, count, batch);
        given_ += count;
        return true;
    }

  private:
    void chooseColumns() {
        if (options_.corridor) {
            header_.columns.push_back(
                {std::string(stationColumn), ColumnType::Float64, 1, 0, "distance along the line"});
            header_.columns.push_back({std::string(offsetColumn), ColumnType::Float64, 1, 0,
                                       "distance from the line, to its right"});
            alongBytes_ = 2 * sizeof(double);
        }
        std::vector<ColumnType> types;
        const auto& all = file_->facts().columns;
        for (const KeptColumn& kept : all) types.push_back(kept.column.type);
        places_ = placesInRow(types);
        const auto taken = [](const auto& three, std::size_t c) {
            return three && std::ranges::find(*three, c) != three->end();
        };
        for (std::size_t c = 0; c < all.size() && options_.columns; ++c) {
            if (taken(decoder_.positions(), c) || taken(decoder_.normals(), c)) continue;
            kept_.push_back(c);
            header_.columns.push_back(all[c].column);
        }
        stride_ = rowBytes(header_.columns);
    }

    /// Some leaves, side by side.
    Expected<void> decodeSome() {
        const std::size_t begin = next_;
        std::size_t points = 0;
        while (next_ < leaves_.size()) {
            const std::size_t more = file_->nodes()[leaves_[next_].node].node.sampleCount;
            if (next_ > begin && points + more > batchPoints) break;
            points += more;
            ++next_;
        }
        const std::size_t count = next_ - begin;
        std::vector<Expected<DecodedLeaf>> leaves(count);
        tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
            leaves[i] = options_.stop.stop_requested() ? abandoned()
                                                       : decoder_.decode(leaves_[begin + i], !kept_.empty());
        });
        std::vector<std::size_t> first{0};
        for (const auto& leaf : leaves) {
            if (!leaf) return passOn(leaf);
            if (auto ok = checkRows(*leaf); !ok) return ok;
            first.push_back(first.back() + leaf->size());
        }
        makeRoom(first.back());
        tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) { take(*leaves[i], first[i]); });
        held_.position = std::move(positions_);
        positions_ = {};
        return {};
    }

    Expected<void> checkRows(const DecodedLeaf& leaf) const {
        if (leaf.rows.empty() || leaf.rows.size() == leaf.samples.size() * places_.front().rowBytes)
            return {};
        return fail(ErrorCode::Malformed,
                    file_->path().string() +
                        " has not as many rows as samples in one of its nodes; the file is damaged");
    }

    void makeRoom(std::size_t count) {
        positions_.resize(count);
        held_.color.resize(header_.attributes.color ? count : 0);
        held_.intensity.resize(header_.attributes.intensity ? count : 0);
        held_.classification.resize(header_.attributes.classification ? count : 0);
        held_.normal.resize(header_.attributes.normal ? count : 0);
        held_.rows.resize(count * stride_);
    }

    void take(const DecodedLeaf& leaf, std::size_t first) {
        for (std::size_t i = 0; i < leaf.size(); ++i) {
            const Sample& s = leaf.samples[leaf.at(i)];
            positions_[first + i] = leaf.places[leaf.at(i)];
            if (!held_.color.empty()) held_.color[first + i] = {s.r, s.g, s.b};
            if (!held_.intensity.empty()) held_.intensity[first + i] = s.intensity;
            if (!held_.classification.empty()) held_.classification[first + i] = s.classification;
            if (!held_.normal.empty()) held_.normal[first + i] = decodeNormal(s.normal);
        }
        for (std::size_t i = 0; i < leaf.along.size(); ++i) {
            std::byte* to = held_.rows.data() + (first + i) * stride_;
            storeLe(to, leaf.along[i].station);
            storeLe(to + sizeof(double), leaf.along[i].offset);
        }
        if (!leaf.rows.empty()) takeRows(leaf, first);
    }

    /// The columns that are columns, and normals, which come out of others.
    void takeRows(const DecodedLeaf& leaf, std::size_t first) {
        const std::size_t from = places_.front().rowBytes;
        const bool asTheyAre = kept_.size() == places_.size();
        for (std::size_t i = 0; i < leaf.size(); ++i) {
            const std::byte* row = leaf.rows.data() + leaf.at(i) * from;
            std::byte* to = held_.rows.data() + (first + i) * stride_ + alongBytes_;
            if (asTheyAre) {
                std::memcpy(to, row, from);
                continue;
            }
            for (const std::size_t c : kept_) {
                std::memcpy(to, row + places_[c].offset, places_[c].bytes);
                to += places_[c].bytes;
            }
            if (!decoder_.normals() || held_.normal.empty()) continue;
            for (int a = 0; a < 3; ++a)
                held_.normal[first + i][a] =
                    loadLe<float>(row + places_[(*decoder_.normals())[std::size_t(a)]].offset);
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

    const LeafDecoder decoder_;
    const std::shared_ptr<const CloudFile> file_;
    const std::vector<WantedLeaf> leaves_;
    const CloudPointsOptions options_;
    std::size_t next_ = 0;
    ScanHeader header_;
    std::vector<PlaceInRow> places_;  ///< of the file's columns
    std::vector<std::size_t> kept_;   ///< those that come out as columns
    std::size_t stride_ = 0, alongBytes_ = 0;
    std::vector<glm::dvec3> positions_;  ///< of what is being decoded
    PointBatch held_;                    ///< decoded, and given away as far as given_
    std::size_t given_ = 0;
};

}  // namespace

std::unique_ptr<PointSource> cloudPoints(std::shared_ptr<const CloudFile> file,
                                         const CloudPointsOptions& options) {
    auto leaves = wantedLeaves(*file, options);
    return cloudPoints(std::move(file), options, std::move(leaves));
}

std::unique_ptr<PointSource> cloudPoints(std::shared_ptr<const CloudFile> file,
                                         const CloudPointsOptions& options, std::vector<WantedLeaf> leaves) {
    return std::make_unique<CloudPoints>(std::move(file), options, std::move(leaves));
}

}  // namespace scancast
