// PLY, binary and little-endian, with coordinates of double precision.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstring>

#include "files/bytes.hpp"
#include "renderer/cloud/export/column_values.hpp"
#include "renderer/cloud/export/export_writer.hpp"
#include "renderer/cloud/export/rows_in_parallel.hpp"
#include "renderer/cloud/import/crs_text.hpp"

namespace scancast {

namespace {

constexpr std::array<std::string_view, 12> plyNames{
    "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "intensity", "classification", "alpha"};
/// Digits of the largest count of points: the head has room for them, whatever the count will be.
constexpr std::size_t countDigits = 20;

/// As PLY calls it; what it has no type for, and what has a scale, becomes a double.
const char* plyType(const OutColumn& column) {
    if (column.scaled()) return "double";
    switch (column.column.type) {
        case ColumnType::Int8:
            return "char";
        case ColumnType::Uint8:
            return "uchar";
        case ColumnType::Int16:
            return "short";
        case ColumnType::Uint16:
            return "ushort";
        case ColumnType::Int32:
            return "int";
        case ColumnType::Uint32:
            return "uint";
        case ColumnType::Float32:
            return "float";
        case ColumnType::Int64:
        case ColumnType::Uint64:
        case ColumnType::Float64:
            break;
    }
    return "double";
}

bool isLong(const Column& column) {
    return column.type == ColumnType::Int64 || column.type == ColumnType::Uint64;
}

class PlyExport final : public ExportWriter {
  public:
    PlyExport(OutputFile output, const ScanHeader& header)
        : output_(std::move(output)),
          header_(header),
          columns_(outColumns(header, plyNames)),
          stride_(rowBytes(header.columns)) {
        const Attributes& has = header.attributes;
        bytes_ = 3 * sizeof(double) + (has.normal ? 12u : 0u) + (has.color ? 3u : 0u) +
                 (has.intensity ? 2u : 0u) + (has.classification ? 1u : 0u);
        for (const OutColumn& column : columns_) bytes_ += bytesIn(column);
    }

    Expected<void> begin(std::uint64_t points) {
        const std::string text = head(points);
        return output_.write(std::as_bytes(std::span(text)));
    }

    Expected<void> write(const PointBatch& batch) override {
        rows_.resize(batch.size() * bytes_);
        inBlocks(batch.size(), [&](std::size_t, std::size_t first, std::size_t end) {
            std::byte* to = rows_.data() + first * bytes_;
            for (std::size_t i = first; i < end; ++i) to = record(batch, i, to);
        });
        return output_.write(rows_);
    }

    Expected<void> finish(const PointSurvey& survey) override {
        if (output_.seekable()) {
            const std::string text = head(survey.points);
            if (auto ok = output_.overwrite(0, std::as_bytes(std::span(text))); !ok) return ok;
        }
        return output_.finish();
    }

    std::uint64_t bytesWritten() const override { return output_.bytesWritten(); }

    std::vector<std::string> losses() const override {
        std::vector<std::string> all;
        if (!header_.crsWkt.empty() || header_.crsEpsg)
            all.push_back("the coordinate reference system stands in a comment, by its name only");
        for (const OutColumn& column : columns_)
            if (isLong(column.column))
                all.push_back(fmt::format(
                    "{}: whole numbers beyond 2^53 are rounded, which PLY has no type for", column.name));
        return all;
    }

  private:
    static std::size_t bytesIn(const OutColumn& column) {
        return column.scaled() ? sizeof(double) : bytesOf(column.column.type);
    }

    /// As long with any number of points.
    std::string head(std::uint64_t points) const {
        const std::string count = std::to_string(points);
        std::string text = fmt::format("ply\nformat binary_little_endian 1.0\ncomment scancast export {}\n",
                                       std::string(countDigits - count.size(), '-'));
        if (const auto crs = crsName(header_.crsWkt, header_.crsEpsg); !crs.empty())
            text += fmt::format("comment crs {}\n", crs);
        text += fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
                            count);
        const Attributes& has = header_.attributes;
        if (has.normal) text += "property float nx\nproperty float ny\nproperty float nz\n";
        if (has.color) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        if (has.intensity) text += "property ushort intensity\n";
        if (has.classification) text += "property uchar classification\n";
        for (const OutColumn& column : columns_)
            text += fmt::format("property {} {}\n", plyType(column), column.name);
        return text + "end_header\n";
    }

    template <class T>
    static std::byte* put(std::byte* to, T value) {
        storeLe(to, value);
        return to + sizeof value;
    }

    std::byte* record(const PointBatch& batch, std::size_t i, std::byte* to) const {
        for (int a = 0; a < 3; ++a) to = put(to, batch.position[i][a]);
        const Attributes& has = header_.attributes;
        if (has.normal)
            for (int a = 0; a < 3; ++a) to = put(to, batch.normal.empty() ? 0.0f : batch.normal[i][a]);
        if (has.color)
            for (std::size_t c = 0; c < 3; ++c)
                to = put(to, batch.color.empty() ? std::uint8_t(255) : batch.color[i][c]);
        if (has.intensity) to = put(to, batch.intensity.empty() ? std::uint16_t(0) : batch.intensity[i]);
        if (has.classification)
            to = put(to, batch.classification.empty() ? std::uint8_t(0) : batch.classification[i]);
        const std::byte* row = batch.rows.data() + i * stride_;
        for (const OutColumn& column : columns_) {
            if (column.scaled() || isLong(column.column)) {
                to = put(to, valueOf(row, column));
                continue;
            }
            std::memcpy(to, row + column.at, bytesIn(column));
            to += bytesIn(column);
        }
        return to;
    }

    OutputFile output_;
    ScanHeader header_;
    std::vector<OutColumn> columns_;
    std::size_t stride_;
    std::size_t bytes_ = 0;  ///< of a record
    std::vector<std::byte> rows_;
};

}  // namespace

Expected<std::unique_ptr<ExportWriter>> createPlyExport(OutputFile output, const ScanHeader& header,
                                                        const PointSurvey& ahead) {
    auto writer = std::make_unique<PlyExport>(std::move(output), header);
    if (auto ok = writer->begin(ahead.points); !ok) return passOn(ok);
    return writer;
}

}  // namespace scancast
