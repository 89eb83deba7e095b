#include "renderer/cloud/exact_scan.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/forwarding_source.hpp"

namespace scancast {

namespace {

class ExactScan final : public ForwardingSource {
  public:
    ExactScan(std::unique_ptr<PointSource> source, bool onOneGrid)
        : ForwardingSource(std::move(source)),
          header_(this->source().header()),
          stride_(rowBytes(header_.columns)) {
        normals_ = header_.attributes.normal;
        positions_ = !onOneGrid;
        if (normals_) add(exactNormalNames, ColumnType::Float32, "normal, of unit length");
        if (positions_) add(exactPositionNames, ColumnType::Float64, "coordinate");
    }

    const ScanHeader& header() const override { return header_; }

    Expected<PointBatch> glance() override {
        auto points = source().glance();
        if (points) points->rows.clear();  // these are for read() to give
        return points;
    }

    Expected<bool> read(PointBatch& batch) override {
        auto more = source().read(batch);
        header_.scannerOrigin = source().header().scannerOrigin;
        if (more && *more && (normals_ || positions_)) widenRows(batch);
        return more;
    }

  private:
    void add(const ThreeNames& names, ColumnType type, const char* description) {
        for (const std::string_view name : names)
            header_.columns.push_back({std::string(name), type, 1, 0, description});
    }

    void widenRows(PointBatch& batch) {
        const std::size_t wide = rowBytes(header_.columns);
        rows_.assign(batch.size() * wide, std::byte(0));
        for (std::size_t i = 0; i < batch.size(); ++i) {
            std::byte* to = rows_.data() + i * wide;
            if (stride_ > 0) std::memcpy(to, batch.rows.data() + i * stride_, stride_);
            to += stride_;
            if (normals_) {
                if (!batch.normal.empty()) std::memcpy(to, &batch.normal[i], 3 * sizeof(float));
                to += 3 * sizeof(float);
            }
            if (!positions_) continue;
            const glm::dvec3 p = batch.position[i];
            std::memcpy(to, &p, 3 * sizeof(double));
        }
        std::swap(batch.rows, rows_);
    }

    ScanHeader header_;
    std::size_t stride_;
    bool normals_ = false, positions_ = false;
    std::vector<std::byte> rows_;
};

}  // namespace

bool shareOneGrid(const std::vector<std::unique_ptr<PointSource>>& sources) {
    return std::ranges::all_of(sources, [&](const std::unique_ptr<PointSource>& source) {
        const ScanHeader &a = source->header(), &b = sources.front()->header();
        return a.gridStep.x > 0 && a.gridStep.y > 0 && a.gridStep.z > 0 && a.gridStep == b.gridStep &&
               a.gridOrigin == b.gridOrigin;
    });
}

std::unique_ptr<PointSource> exactScan(std::unique_ptr<PointSource> source, bool onOneGrid) {
    return std::make_unique<ExactScan>(std::move(source), onOneGrid);
}

}  // namespace scancast
