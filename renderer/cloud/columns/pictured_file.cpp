#include "renderer/cloud/columns/pictured_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <utility>

#include "renderer/cloud/columns/stored_values.hpp"

namespace scancast {
namespace {

using Bytes = std::vector<std::byte>;
/// The numbers of a node's samples that are left, in their order.
using Kept = std::shared_ptr<const std::vector<std::uint32_t>>;

class PicturedFile final : public CloudFile {
  public:
    PicturedFile(std::shared_ptr<const CloudFile> file, ColumnChoice choice, SamplesAtHand atHand)
        : file_(std::move(file)),
          choice_(std::move(choice)),
          atHand_(std::move(atHand)),
          facts_(file_->facts()) {
        if (choice_.color) facts_.attributes.intensity = true;
        for (const StoredNode& stored : file_->nodes())
            largest_ = std::max<std::uint64_t>(largest_, stored.node.sampleCount);
        const auto planes = file_->planes();
        for (const KeptColumn& kept : facts_.columns) {
            const auto at = std::ranges::find(planes, innerPlane(kept.column));
            inner_.push_back(at == planes.end() ? std::nullopt
                                                : std::optional(std::size_t(at - planes.begin())));
        }
    }

    const std::filesystem::path& path() const override { return file_->path(); }
    std::uint64_t bytes() const override { return file_->bytes(); }
    bool isRemote() const override { return file_->isRemote() || file_->isNative(); }
    bool countsVary() const override { return true; }
    std::uint64_t ownMemory() const override {
        return rememberedNodes * std::min<std::uint64_t>(largest_, mostRemembered) * sizeof(std::uint32_t);
    }
    bool isAway() const override { return file_->isAway(); }
    const CloudFacts& facts() const override { return facts_; }
    std::span<const BlockPlace> photoPlaces() const override { return file_->photoPlaces(); }
    std::string_view writtenBy() const override { return file_->writtenBy(); }
    std::span<const StoredNode> nodes() const override { return file_->nodes(); }
    std::span<const ValuePlane> planes() const override { return file_->planes(); }
    BlockPlace planePlace(std::uint32_t node, std::size_t index) const override {
        return file_->planePlace(node, index);
    }

    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        auto all = allSamples(node);
        if (!all) return all;
        const auto kept = keptOf(node, *all);
        if (!kept) return passOn(kept);
        if (choice_.color)
            if (auto ok = paint(node, *all); !ok) return passOn(ok);
        if ((*kept)->size() == all->size()) return all;
        std::vector<Sample> left;
        left.reserve((*kept)->size());
        for (const std::uint32_t i : **kept) left.push_back((*all)[i]);
        return left;
    }

    Expected<Bytes> plane(std::uint32_t node, std::size_t index) const override {
        auto all = file_->plane(node, index);
        if (!all || all->empty()) return all;
        return keepOf(node, std::move(*all), bytesOf(planes()[index].type));
    }

    Expected<Bytes> rows(std::uint32_t node) const override {
        auto all = file_->rows(node);
        if (!all || all->empty()) return all;
        std::size_t bytes = 0;
        for (const KeptColumn& kept : facts_.columns) bytes += bytesOf(kept.column.type);
        return keepOf(node, std::move(*all), bytes);
    }

    Expected<KeptPoint> point(std::uint32_t leaf, std::span<const Sample>, std::size_t index) const override {
        const auto all = allSamples(leaf);
        if (!all) return passOn(all);
        const auto kept = keptOf(leaf, *all);
        if (!kept) return passOn(kept);
        if (index >= (*kept)->size())
            return fail(ErrorCode::InvalidArgument, "There is no such point within the filter.");
        return file_->point(leaf, *all, (**kept)[index]);
    }

  private:
    /// Planes of a node that are read one after the other, and its picks, need not be filtered anew.
    static constexpr std::size_t rememberedNodes = 4, mostRemembered = 65536;

    Expected<std::vector<Sample>> allSamples(std::uint32_t node) const {
        if (atHand_)
            if (const auto run = atHand_(node))
                return std::vector<Sample>(run->samples.begin(), run->samples.end());
        return file_->samples(node);
    }

    /// Of all samples of a node, in their order.
    Expected<std::vector<double>> valuesOfNode(std::uint32_t node, const ChosenValue& value,
                                               std::span<const Sample> all) const {
        if (value.from == ValueFrom::Column) return columnOf(node, value.column, all.size());
        std::vector<double> values;
        values.reserve(all.size());
        for (const Sample& s : all)
            values.push_back(value.from == ValueFrom::Intensity ? s.intensity : s.classification);
        return values;
    }

    /// A leaf's own, or an inner node's companion's.
    Expected<std::vector<double>> columnOf(std::uint32_t node, std::size_t column, std::size_t count) const {
        const bool isLeaf = file_->nodes()[node].node.isLeaf();
        const std::optional<std::size_t> plane = isLeaf ? std::optional(column) : inner_[column];
        if (!plane)
            return fail(ErrorCode::Unsupported,
                        "The cloud file has no values of this column in inner nodes.");
        const auto stored = file_->plane(node, *plane);
        if (!stored) return passOn(stored);
        auto values = valuesOf(*stored, facts_.columns[column].column);
        if (values.size() == count) return values;
        return fail(ErrorCode::Malformed, path().string() + ": node " + std::to_string(node) +
                                              " has not as many values of a column as samples");
    }

    Expected<Kept> keptOf(std::uint32_t node, std::span<const Sample> all) const {
        if (auto known = remembered(node)) return known;
        std::vector<std::uint32_t> left(all.size());
        for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
        for (const ChosenRange& chosen : choice_.filter) {
            if (left.empty()) break;
            if (auto ok = keepWithin(chosen, node, all, left); !ok) return passOn(ok);
        }
        auto kept = std::make_shared<const std::vector<std::uint32_t>>(std::move(left));
        remember(node, kept);
        return Kept(std::move(kept));
    }

    Expected<void> keepWithin(const ChosenRange& chosen, std::uint32_t node, std::span<const Sample> all,
                              std::vector<std::uint32_t>& left) const {
        const auto values = valuesOfNode(node, chosen.value, all);
        if (!values) return passOn(values);
        std::erase_if(left, [&](std::uint32_t i) { return !chosen.range.has((*values)[i]); });
        return {};
    }

    Expected<void> paint(std::uint32_t node, std::vector<Sample>& all) const {
        const auto values = valuesOfNode(node, *choice_.color, all);
        if (!values) return passOn(values);
        for (std::size_t i = 0; i < all.size(); ++i) all[i].intensity = codeOf((*values)[i], choice_.ends);
        return {};
    }

    /// Of values of all samples, those of the ones that are left.
    Expected<Bytes> keepOf(std::uint32_t node, Bytes all, std::size_t bytes) const {
        if (choice_.filter.empty()) return all;
        Kept kept = remembered(node);
        if (!kept) {
            const auto samples = allSamples(node);
            if (!samples) return passOn(samples);
            auto found = keptOf(node, *samples);
            if (!found) return passOn(found);
            kept = std::move(*found);
        }
        Bytes left;
        left.reserve(kept->size() * bytes);
        for (const std::uint32_t i : *kept) {
            if ((i + std::size_t(1)) * bytes > all.size())
                return fail(ErrorCode::Malformed, path().string() + ": node " + std::to_string(node) +
                                                      " has fewer values than samples");
            const auto from = all.begin() + std::ptrdiff_t(i * bytes);
            left.insert(left.end(), from, from + std::ptrdiff_t(bytes));
        }
        return left;
    }

    Kept remembered(std::uint32_t node) const {
        const std::lock_guard lock(guard_);
        for (const auto& [known, kept] : remembered_)
            if (kept && known == node) return kept;
        return nullptr;
    }
    void remember(std::uint32_t node, Kept kept) const {
        if (kept->size() > mostRemembered) return;
        const std::lock_guard lock(guard_);
        remembered_[next_++ % rememberedNodes] = {node, std::move(kept)};
    }

    const std::shared_ptr<const CloudFile> file_;
    const ColumnChoice choice_;
    const SamplesAtHand atHand_;
    CloudFacts facts_;
    std::uint64_t largest_ = 0;                      ///< samples of a node
    std::vector<std::optional<std::size_t>> inner_;  ///< of each column, its inner nodes' plane
    mutable std::mutex guard_;                       // of what follows
    mutable std::array<std::pair<std::uint32_t, Kept>, rememberedNodes> remembered_{};
    mutable std::size_t next_ = 0;
};

}  // namespace

std::uint16_t codeOf(double value, const std::array<double, 2>& ends) {
    if (!(value > ends[0])) return 0;  // NaN as well
    if (value >= ends[1]) return std::uint16_t(greatestCode);
    return std::uint16_t(std::lround((value - ends[0]) / (ends[1] - ends[0]) * greatestCode));
}

std::shared_ptr<const CloudFile> picturedFile(std::shared_ptr<const CloudFile> file, ColumnChoice choice,
                                              SamplesAtHand atHand) {
    return std::make_shared<PicturedFile>(std::move(file), std::move(choice), std::move(atHand));
}

Expected<std::shared_ptr<const CloudFile>> picturedLeaves(std::shared_ptr<const CloudFile> file,
                                                          const ColumnRanges& filter, const Style& style) {
    Style asked = style;
    asked.filter = filter;
    auto choice = chooseColumns(file->facts(), asked, false);
    if (!choice) return passOn(choice);
    if (choice->isNothing()) return file;
    return picturedFile(std::move(file), std::move(*choice));
}

}  // namespace scancast
