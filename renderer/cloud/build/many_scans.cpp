#include "renderer/cloud/build/many_scans.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "renderer/cloud/build/merged_crs.hpp"

namespace scancast {

namespace {

/// Where the columns of one scan stand in the rows of all.
struct ColumnCopy {
    std::size_t from = 0, to = 0, bytes = 0;
};

/// More would be no table, and the facts of a cloud file have an end.
constexpr std::size_t mostMergedColumns = 512;

bool sameValues(const Column& a, const Column& b) {
    return a.name == b.name && a.type == b.type && a.scale == b.scale && a.offset == b.offset;
}

std::vector<ColumnCopy> matchColumns(std::span<const Column> from, std::span<const Column> to) {
    std::vector<ColumnCopy> copies;
    std::size_t toAt = 0;
    for (const Column& wanted : to) {
        std::size_t fromAt = 0;
        for (const Column& column : from) {
            if (sameValues(column, wanted)) copies.push_back({fromAt, toAt, bytesOf(column.type)});
            fromAt += bytesOf(column.type);
        }
        toAt += bytesOf(wanted.type);
    }
    return copies;
}

ScanCrs scanCrs(const ScanHeader& header, std::string name) {
    return {std::move(name), header.crsWkt, header.crsEpsg, header.bounds};
}

class ScansInTurn final : public ManyScans {
  public:
    ScansInTurn(std::vector<std::unique_ptr<PointSource>> sources, std::vector<ScanCrs> crs, MergedCrs merged,
                bool judges)
        : sources_(std::move(sources)), crs_(std::move(crs)), merged_(std::move(merged)), judges_(judges) {
        mergeHeaders();
        const auto wanted = mergeColumns();
        for (const auto& source : sources_) copies_.push_back(matchColumns(source->header().columns, wanted));
    }

    const ScanHeader& header() const override { return header_; }

    Expected<bool> read(PointBatch& batch) override {
        for (; at_ < sources_.size(); ++at_) {
            const auto more = sources_[at_]->read(batch);
            if (!more) return more;
            if (sources_.size() == 1) header_.scannerOrigin = sources_.front()->header().scannerOrigin;
            if (!*more) continue;
            for (const std::uint16_t value : batch.nearInfrared)
                seen_[at_].highestInfrared = std::max(seen_[at_].highestInfrared, value);
            arrangeRows(batch);
            if (merged_.boundsMatter) see(batch);
            if (!batch.scanner) batch.scanner = sources_[at_]->header().scannerOrigin;
            return true;
        }
        batch.clear();
        if (!judges_) return false;
        if (auto ok = judge(); !ok) return passOn(ok);
        return false;
    }

    std::span<SeenOfScan> seen() override { return seen_; }

    /// Those that did not say where they lie may turn out to lie far from the others.
    Expected<void> judge() override {
        if (sources_.size() == 1) header_.scannerOrigin = sources_.front()->header().scannerOrigin;
        if (!merged_.boundsMatter || isJudged_) return {};
        for (std::size_t i = 0; i < crs_.size(); ++i)
            if (!hasPlace(crs_[i])) crs_[i].bounds = seen_[i].box;
        isJudged_ = true;
        auto merged = mergeCrs(crs_);
        if (!merged) return passOn(merged);
        merged_.notes = std::move(merged->notes);
        return {};
    }

    std::uint64_t droppedPoints() const override {
        std::uint64_t sum = 0;
        for (const auto& source : sources_) sum += source->droppedPoints();
        return sum;
    }

    std::vector<std::string> notes() const override {
        std::vector<std::string> all = merged_.notes;
        for (const auto& source : sources_)
            for (std::string& note : source->notes()) all.push_back(std::move(note));
        const auto dark = std::ranges::count_if(
            seen_, [](const SeenOfScan& s) { return s.highestInfrared > 0 && s.highestInfrared < 256; });
        if (dark > 0 &&
            std::ranges::any_of(seen_, [](const SeenOfScan& s) { return s.highestInfrared > 255; }))
            all.push_back(
                fmt::format("near infrared has 8 bits in {} of the scans and 16 in others: that of 8 is "
                            "black beside these",
                            dark));
        if (columnsLeftOut_ > 0)
            all.push_back(fmt::format("the scans have {} columns more than the {} that are kept",
                                      columnsLeftOut_, mostMergedColumns));
        return all;
    }

    std::vector<Station> stations() const override {
        std::vector<Station> all;
        for (const auto& source : sources_)
            for (Station& station : source->stations()) all.push_back(std::move(station));
        return all;
    }

    std::vector<Photo> photos() const override {
        std::vector<Photo> all;
        std::size_t before = 0;  // stations of the scans before this one
        for (const auto& source : sources_) {
            for (Photo& photo : source->photos()) {
                if (photo.station) *photo.station += std::uint32_t(before);
                all.push_back(std::move(photo));
            }
            before += source->stations().size();
        }
        return all;
    }

    std::array<std::uint64_t, 2> bytesRead() const override {
        std::array<std::uint64_t, 2> sum{};
        for (const auto& source : sources_) {
            const auto one = source->bytesRead();
            sum[0] += one[0];
            sum[1] += one[1];
        }
        return sum;
    }

  private:
    void mergeHeaders() {
        header_ = sources_.front()->header();
        std::set<std::string> formats{header_.format};
        for (std::size_t i = 1; i < sources_.size(); ++i) {
            const ScanHeader& other = sources_[i]->header();
            formats.insert(other.format);
            header_.attributes.color |= other.attributes.color;
            header_.attributes.intensity |= other.attributes.intensity;
            header_.attributes.classification |= other.attributes.classification;
            header_.attributes.normal |= other.attributes.normal;
            header_.attributes.nearInfrared |= other.attributes.nearInfrared;
            header_.points = header_.points && other.points ? std::optional(*header_.points + *other.points)
                                                            : std::nullopt;
            if (header_.gridStep != other.gridStep) header_.gridStep = glm::dvec3(0);
            header_.scannerOrigin.reset();  // each stood elsewhere
            header_.bounds.reset();
        }
        if (sources_.size() == 1) return;
        header_.crsWkt = merged_.wkt;
        header_.crsEpsg = merged_.epsg;
        std::string names;
        for (const std::string& format : formats) names += (names.empty() ? "" : "; ") + format;
        header_.format = fmt::format("{} scans: {}", sources_.size(), names);
    }

    /// Those of the first scan, then what others have beside them: 0 for points of scans without. What is called alike
    /// and is not gets another name; returned is what each is called where it comes from.
    std::vector<Column> mergeColumns() {
        std::vector<Column> wanted = header_.columns;
        for (const auto& source : sources_)
            for (const Column& column : source->header().columns) {
                if (std::ranges::any_of(wanted, [&](const Column& c) { return sameValues(c, column); }))
                    continue;
                if (wanted.size() >= mostMergedColumns) {
                    ++columnsLeftOut_;
                    continue;
                }
                wanted.push_back(column);
                header_.columns.push_back(column);
                header_.columns.back().name = freeName(column.name);
            }
        return wanted;
    }

    std::string freeName(const std::string& wanted) const {
        std::string name = wanted;
        const auto taken = [&] {
            return std::any_of(header_.columns.begin(), header_.columns.end() - 1,
                               [&](const Column& c) { return c.name == name; });
        };
        for (int copy = 2; taken(); ++copy) name = fmt::format("{}_{}", wanted, copy);
        return name;
    }

    void see(const PointBatch& batch) {
        auto& [low, high] = seen_[at_].box;
        for (const glm::dvec3& p : batch.position) low = glm::min(low, p), high = glm::max(high, p);
    }

    void arrangeRows(PointBatch& batch) {
        const auto& theirs = sources_[at_]->header().columns;
        if (theirs == header_.columns) return;
        const std::size_t stride = rowBytes(header_.columns), theirStride = rowBytes(theirs);
        std::vector<std::byte> rows(batch.size() * stride);
        for (std::size_t i = 0; i < batch.size(); ++i)
            for (const ColumnCopy& c : copies_[at_])
                std::copy_n(batch.rows.begin() + std::ptrdiff_t(i * theirStride + c.from), c.bytes,
                            rows.begin() + std::ptrdiff_t(i * stride + c.to));
        batch.rows = std::move(rows);
    }

    std::vector<std::unique_ptr<PointSource>> sources_;
    std::vector<ScanCrs> crs_;
    MergedCrs merged_;
    std::vector<SeenOfScan> seen_ = std::vector<SeenOfScan>(sources_.size());  ///< boxes where they matter
    const bool judges_;
    bool isJudged_ = false;
    std::vector<std::vector<ColumnCopy>> copies_;
    ScanHeader header_;
    std::size_t columnsLeftOut_ = 0;
    std::size_t at_ = 0;
};

Expected<std::unique_ptr<ManyScans>> inTurn(std::vector<std::unique_ptr<PointSource>> sources,
                                            std::span<const std::string> names, bool judges) {
    std::vector<ScanCrs> crs;
    for (std::size_t i = 0; i < sources.size(); ++i)
        crs.push_back(
            scanCrs(sources[i]->header(), i < names.size() ? names[i] : fmt::format("scan {}", i + 1)));
    auto merged = mergeCrs(crs);
    if (!merged) return passOn(merged);
    return std::make_unique<ScansInTurn>(std::move(sources), std::move(crs), std::move(*merged), judges);
}

}  // namespace

Expected<std::unique_ptr<PointSource>> manyScans(std::vector<std::unique_ptr<PointSource>> sources,
                                                 std::span<const std::string> names) {
    return inTurn(std::move(sources), names, true);
}

Expected<std::unique_ptr<ManyScans>> manyScansInPart(std::vector<std::unique_ptr<PointSource>> sources,
                                                     std::span<const std::string> names) {
    return inTurn(std::move(sources), names, false);
}

}  // namespace scancast
