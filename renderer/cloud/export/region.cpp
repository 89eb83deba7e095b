#include "renderer/cloud/export/region.hpp"

#include <cstring>

#include "renderer/cloud/forwarding_source.hpp"

namespace scancast {

namespace {

template <class Values>
void keepOf(Values& values, const std::vector<std::uint32_t>& kept) {
    if (values.empty()) return;
    for (std::size_t to = 0; to < kept.size(); ++to) values[to] = values[kept[to]];
    values.resize(kept.size());
}

class RegionSource final : public ForwardingSource {
  public:
    RegionSource(const PointsRegion& region, std::unique_ptr<PointSource> source)
        : ForwardingSource(std::move(source)), region_(region), header_(this->source().header()) {
        header_.points.reset();
        header_.bounds.reset();
    }

    const ScanHeader& header() const override { return header_; }
    Expected<PointBatch> glance() override {
        auto points = source().glance();
        if (!points) return points;
        keepWithin(region_, points->rows.empty() ? 0 : rowBytes(header_.columns), *points);
        return points;
    }
    Expected<bool> read(PointBatch& batch) override {
        for (;;) {
            auto more = source().read(batch);
            if (!more || !*more) return more;
            keepWithin(region_, rowBytes(header_.columns), batch);
            if (batch.size() > 0) return true;
        }
    }

  private:
    RegionTest region_;
    ScanHeader header_;
};

}  // namespace

RegionTest::RegionTest(PointsRegion region) : region_(std::move(region)) {
    if (region_.polygon) polygon_.emplace(*region_.polygon);
    if (region_.clips.empty()) return;
    const ClipShape& first = region_.clips.front();
    const auto* const half = std::get_if<HalfSpace>(&first);
    clipsOrigin_ = half != nullptr ? half->point : std::get<TurnedBox>(first).center;
    clips_ = clipRegions(region_.clips, clipsOrigin_);
}

bool RegionTest::contains(const glm::dvec3& p) const {
    if (region_.clip)
        for (int a = 0; a < 3; ++a)
            if (p[a] < region_.clip->min[a] || p[a] > region_.clip->max[a]) return false;
    if (region_.z && (p.z < (*region_.z)[0] || p.z > (*region_.z)[1])) return false;
    if (polygon_ && !polygon_->contains(glm::dvec2(p))) return false;
    return clips_.empty() || clips_.contains(p - clipsOrigin_);
}

Within RegionTest::of(const glm::dvec3& low, const glm::dvec3& high) const {
    bool inside = true;
    const auto slab = [&](double least, double most, int a) {
        if (low[a] > most || high[a] < least) return false;
        inside = inside && low[a] >= least && high[a] <= most;
        return true;
    };
    if (region_.clip)
        for (int a = 0; a < 3; ++a)
            if (!slab(region_.clip->min[a], region_.clip->max[a], a)) return Within::Outside;
    if (region_.z && !slab((*region_.z)[0], (*region_.z)[1], 2)) return Within::Outside;
    if (polygon_) {
        const Within plan = polygon_->of(glm::dvec2(low), glm::dvec2(high));
        if (plan == Within::Outside) return plan;
        inside = inside && plan == Within::Inside;
    }
    if (!clips_.empty()) {
        const Overlap left = clips_.overlap(low - clipsOrigin_, high - clipsOrigin_);
        if (left == Overlap::None) return Within::Outside;
        inside = inside && left == Overlap::All;
    }
    return inside ? Within::Inside : Within::Across;
}

void keepWithin(const RegionTest& region, std::size_t rowBytes, PointBatch& batch) {
    std::vector<std::uint32_t> kept;
    kept.reserve(batch.size());
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (!region.contains(batch.position[i])) continue;
        if (!region.takes(batch.classification.empty() ? std::uint8_t(0) : batch.classification[i])) continue;
        kept.push_back(std::uint32_t(i));
    }
    if (kept.size() == batch.size()) return;
    std::vector<glm::dvec3> positions;
    positions.reserve(kept.size());
    for (const std::uint32_t i : kept) positions.push_back(batch.position[i]);
    batch.position = std::move(positions);
    keepOf(batch.color, kept);
    keepOf(batch.intensity, kept);
    keepOf(batch.classification, kept);
    keepOf(batch.normal, kept);
    keepOf(batch.nearInfrared, kept);
    if (rowBytes == 0) return;
    for (std::size_t to = 0; to < kept.size(); ++to)
        std::memmove(batch.rows.data() + to * rowBytes, batch.rows.data() + kept[to] * rowBytes, rowBytes);
    batch.rows.resize(kept.size() * rowBytes);
}

std::unique_ptr<PointSource> within(const PointsRegion& region, std::unique_ptr<PointSource> source) {
    if (region.isEverything()) return source;
    return std::make_unique<RegionSource>(region, std::move(source));
}

}  // namespace scancast
