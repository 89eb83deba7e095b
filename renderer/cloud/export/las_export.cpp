// LAS 1.4: a head that is known to the end, or written again when it is, and one record a point.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/bytes.hpp"
#include "renderer/cloud/export/export_writer.hpp"
#include "renderer/cloud/export/las_layout.hpp"
#include "renderer/cloud/export/rows_in_parallel.hpp"
#include "renderer/cloud/import/las/las_header.hpp"

namespace scancast {

namespace {

/// What a record was to hold and has no room for; counted over all blocks of a batch.
struct LasMisfits {
    std::uint64_t numbers = 0, positions = 0;
};

class LasExport final : public ExportWriter {
  public:
    LasExport(OutputFile output, const ScanHeader& header, LasLayout layout)
        : output_(std::move(output)),
          header_(header),
          layout_(std::move(layout)),
          records_(lasRecords(header, layout_)),
          stride_(rowBytes(header.columns)) {}

    Expected<void> begin(const PointSurvey& ahead) {
        if (auto ok = output_.write(lasHead(layout_, records_, ahead)); !ok) return ok;
        return output_.write(records_.bytes);
    }

    Expected<void> write(const PointBatch& batch) override {
        bytes_.assign(batch.size() * layout_.recordBytes, std::byte(0));
        // What a reader has as steps of this very grid goes out as it came.
        asSteps_ =
            batch.position.areSteps() && batch.position.grid() == StepGrid{layout_.offset, layout_.scale};
        blocks_.assign((batch.size() + exportBlockPoints - 1) / exportBlockPoints, {});
        inBlocks(batch.size(), [&](std::size_t block, std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i)
                record(batch, i, bytes_.data() + i * layout_.recordBytes, blocks_[block]);
        });
        for (const LasMisfits& block : blocks_) {
            misfits_.numbers += block.numbers;
            misfits_.positions += block.positions;
        }
        return output_.write(bytes_);
    }

    Expected<void> finish(const PointSurvey& survey) override {
        if (output_.seekable())
            if (auto ok = output_.overwrite(0, lasHead(layout_, records_, survey)); !ok) return ok;
        return output_.finish();
    }

    std::uint64_t bytesWritten() const override { return output_.bytesWritten(); }

    std::vector<std::string> losses() const override {
        std::vector<std::string> all = records_.losses;
        if (misfits_.positions > 0)
            all.push_back(fmt::format(
                "positions of {} points are rounded to the steps of the file, {:g}, by half a step at most",
                misfits_.positions, std::max({layout_.scale.x, layout_.scale.y, layout_.scale.z})));
        if (misfits_.numbers > 0)
            all.push_back(
                fmt::format("{} numbers are too large for their fields in LAS and became the largest there",
                            misfits_.numbers));
        return all;
    }

  private:
    template <class T>
    T fieldOr(const std::byte* row, LasField field, T otherwise) const {
        const auto at = layout_.field(field);
        return at ? loadLe<T>(row + *at) : otherwise;
    }

    /// So many bits of it, the largest number where they are too few.
    unsigned bits(const std::byte* row, LasField field, unsigned most, unsigned otherwise,
                  LasMisfits& misfits) const {
        const unsigned value = fieldOr<std::uint8_t>(row, field, std::uint8_t(otherwise));
        misfits.numbers += value > most;
        return std::min(value, most);
    }

    void record(const PointBatch& batch, std::size_t i, std::byte* to, LasMisfits& misfits) const {
        const std::byte* row = batch.rows.data() + i * stride_;
        if (asSteps_)
            for (std::size_t a = 0; a < 3; ++a) storeLe(to + 4 * a, batch.position.asSteps()[i][a]);
        else
            putPosition(batch.position[i], to, misfits);
        storeLe(to + 12, batch.intensity.empty() ? std::uint16_t(0) : batch.intensity[i]);
        const unsigned itsClass = batch.classification.empty() ? 0 : batch.classification[i];
        if (layout_.isNew())
            putNewFields(row, itsClass, to, misfits);
        else
            putOldFields(row, itsClass, to, misfits);
        const auto& shape = lasRecordLayout(layout_.pointFormat);
        if (shape.color >= 0) putColor(batch, i, row, to + shape.color);
        if (layout_.pointFormat == 8) storeLe(to + 36, fieldOr<std::uint16_t>(row, LasField::Nir, 0));
        std::byte* extra = to + layout_.fieldBytes;
        for (const LasExtra& e : layout_.extras) {
            std::memcpy(extra, row + e.at, bytesOf(e.column.type));
            extra += bytesOf(e.column.type);
        }
        if (layout_.normals && !batch.normal.empty()) std::memcpy(extra, &batch.normal[i], 3 * sizeof(float));
    }

    void putPosition(const glm::dvec3& p, std::byte* to, LasMisfits& misfits) const {
        bool off = false;
        for (int a = 0; a < 3; ++a) {
            const double exact = (p[a] - layout_.offset[a]) / layout_.scale[a];
            // A damaged grid makes numbers that are none.
            const double q =
                std::isfinite(exact) ? std::clamp(std::nearbyint(exact), -2147483648.0, 2147483647.0) : 0;
            const double tolerance =
                1e-3 * layout_.scale[a] + 1e-15 * (std::abs(p[a]) + std::abs(layout_.offset[a]));
            off = off || !(std::abs(layout_.offset[a] + q * layout_.scale[a] - p[a]) <= tolerance);
            storeLe(to + 4 * a, std::int32_t(q));
        }
        misfits.positions += off;
    }

    void putOldFields(const std::byte* row, unsigned itsClass, std::byte* to, LasMisfits& misfits) const {
        const unsigned returns = bits(row, LasField::ReturnNumber, 7, 1, misfits) |
                                 bits(row, LasField::NumberOfReturns, 7, 1, misfits) << 3 |
                                 bits(row, LasField::ScanDirection, 1, 0, misfits) << 6 |
                                 bits(row, LasField::EdgeOfFlightLine, 1, 0, misfits) << 7;
        misfits.numbers += itsClass > 31;
        const unsigned classes = std::min(itsClass, 31U) | bits(row, LasField::ClassFlags, 7, 0, misfits)
                                                               << 5;
        to[14] = std::byte(returns);
        to[15] = std::byte(classes);
        storeLe(to + 16, fieldOr<std::int8_t>(row, LasField::OldScanAngle, 0));
        storeLe(to + 17, fieldOr<std::uint8_t>(row, LasField::UserData, 0));
        storeLe(to + 18, fieldOr<std::uint16_t>(row, LasField::PointSource, 0));
        if (layout_.pointFormat & 1) storeLe(to + 20, fieldOr<double>(row, LasField::GpsTime, 0));
    }

    void putNewFields(const std::byte* row, unsigned itsClass, std::byte* to, LasMisfits& misfits) const {
        const unsigned returns = bits(row, LasField::ReturnNumber, 15, 1, misfits) |
                                 bits(row, LasField::NumberOfReturns, 15, 1, misfits) << 4;
        const unsigned flags = bits(row, LasField::ClassFlags, 15, 0, misfits) |
                               bits(row, LasField::ScannerChannel, 3, 0, misfits) << 4 |
                               bits(row, LasField::ScanDirection, 1, 0, misfits) << 6 |
                               bits(row, LasField::EdgeOfFlightLine, 1, 0, misfits) << 7;
        to[14] = std::byte(returns);
        to[15] = std::byte(flags);
        to[16] = std::byte(itsClass);
        storeLe(to + 17, fieldOr<std::uint8_t>(row, LasField::UserData, 0));
        // A point has the one or the other, by the scan that it comes from.
        const auto fine = fieldOr<std::int16_t>(row, LasField::NewScanAngle, 0);
        const auto degrees = fieldOr<std::int8_t>(row, LasField::OldScanAngle, 0);
        storeLe(to + 18, fine != 0 ? fine : std::int16_t(std::lround(degrees / lasAngleStep)));
        storeLe(to + 20, fieldOr<std::uint16_t>(row, LasField::PointSource, 0));
        storeLe(to + 22, fieldOr<double>(row, LasField::GpsTime, 0));
    }

    void putColor(const PointBatch& batch, std::size_t i, const std::byte* row, std::byte* to) const {
        for (std::size_t c = 0; c < 3; ++c) {
            // 16 bits a channel, filled by x 257 as the specification asks.
            const unsigned eight = batch.color.empty() ? 255 : batch.color[i][c];
            const auto field = LasField(std::size_t(LasField::Red) + c);
            storeLe(to + 2 * c, fieldOr<std::uint16_t>(row, field, std::uint16_t(eight * 257)));
        }
    }

    OutputFile output_;
    ScanHeader header_;
    LasLayout layout_;
    LasRecords records_;
    std::size_t stride_;
    std::vector<std::byte> bytes_;
    std::vector<LasMisfits> blocks_;
    bool asSteps_ = false;  ///< of the batch being written
    LasMisfits misfits_;
};

}  // namespace

Expected<std::unique_ptr<ExportWriter>> createLasExport(OutputFile output, const ScanHeader& header,
                                                        const PointSurvey& ahead) {
    auto layout = lasLayout(header, ahead);
    if (!layout) return passOn(layout);
    auto writer = std::make_unique<LasExport>(std::move(output), header, std::move(*layout));
    if (auto ok = writer->begin(ahead); !ok) return passOn(ok);
    return writer;
}

}  // namespace scancast
