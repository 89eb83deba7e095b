#include "renderer/cloud/export/region.hpp"

#include <cstring>

#include "renderer/cloud/forwarding_source.hpp"

namespace scancast {

namespace {

bool inside(const glm::dvec3& p, const ClipBox& box) {
    return p.x >= box.min.x && p.x <= box.max.x && p.y >= box.min.y && p.y <= box.max.y && p.z >= box.min.z &&
           p.z <= box.max.z;
}

template <class Values>
void keepOf(Values& values, const std::vector<std::uint32_t>& kept) {
    if (values.empty()) return;
    for (std::size_t to = 0; to < kept.size(); ++to) values[to] = values[kept[to]];
    values.resize(kept.size());
}

class RegionSource final : public ForwardingSource {
  public:
    RegionSource(const ExportRegion& region, std::unique_ptr<PointSource> source)
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
    ExportRegion region_;
    ScanHeader header_;
};

}  // namespace

void keepWithin(const ExportRegion& region, std::size_t rowBytes, PointBatch& batch) {
    std::vector<std::uint32_t> kept;
    kept.reserve(batch.size());
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (region.clip && !inside(batch.position[i], *region.clip)) continue;
        const unsigned itsClass = batch.classification.empty() ? 0 : batch.classification[i];
        if (region.classes && !region.classes->test(itsClass)) continue;
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

std::unique_ptr<PointSource> within(const ExportRegion& region, std::unique_ptr<PointSource> source) {
    if (region.isEverything()) return source;
    return std::make_unique<RegionSource>(region, std::move(source));
}

}  // namespace scancast
