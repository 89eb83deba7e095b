// CSV and its relatives: a line of names, then a line a point.
#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cmath>
#include <string>

#include "renderer/cloud/export/column_values.hpp"
#include "renderer/cloud/export/export_writer.hpp"
#include "renderer/cloud/export/rows_in_parallel.hpp"

namespace scancast {

namespace {

constexpr std::array<std::string_view, 11> textNames{
    "x", "y", "z", "red", "green", "blue", "intensity", "classification", "nx", "ny", "nz"};

class TextBuffer {
  public:
    void character(char c) { text_.push_back(c); }
    template <class Number>
    void number(Number value) {
        char space[40];
        const auto [end, problem] = std::to_chars(space, space + sizeof space, value);
        (void)problem;
        text_.append(space, end);
    }
    /// In units of 10^-digits.
    void decimal(std::int64_t value, int digits) {
        char space[32];
        if (value < 0) text_.push_back('-');
        const auto [end, problem] = std::to_chars(
            space, space + sizeof space, value < 0 ? 0 - std::uint64_t(value) : std::uint64_t(value));
        (void)problem;
        const auto length = int(end - space);
        if (length <= digits) {
            text_.append(digits > 0 ? "0." : "");
            text_.append(std::size_t(digits - length), '0');
            text_.append(space, end);
            return;
        }
        text_.append(space, end - digits);
        if (digits > 0) text_.push_back('.');
        text_.append(end - digits, end);
    }
    void clear() { text_.clear(); }
    std::span<const std::byte> bytes() const { return std::as_bytes(std::span(text_)); }

  private:
    std::string text_;
};

class TextExport final : public ExportWriter {
  public:
    TextExport(OutputFile output, const ScanHeader& header, char separator)
        : output_(std::move(output)),
          header_(header),
          separator_(separator),
          columns_(outColumns(header, textNames)),
          stride_(rowBytes(header.columns)) {
        for (int a = 0; a < 3; ++a)
            if (header.gridStep[a] > 0)
                decimals_[std::size_t(a)] = decimalGrid(header.gridOrigin[a], header.gridStep[a]);
    }

    Expected<void> begin() {
        std::string line = separator_ == ',' ? "" : "//";
        const auto add = [&](std::string_view name) {
            if (!line.empty() && line != "//") line += separator_;
            line += name;
        };
        const auto addSome = [&](std::size_t first, std::size_t count) {
            for (std::size_t i = 0; i < count; ++i) add(textNames[first + i]);
        };
        addSome(0, 3);
        if (header_.attributes.color) addSome(3, 3);
        if (header_.attributes.intensity) addSome(6, 1);
        if (header_.attributes.classification) addSome(7, 1);
        if (header_.attributes.normal) addSome(8, 3);
        for (const OutColumn& column : columns_) add(column.name);
        line += '\n';
        return output_.write(std::as_bytes(std::span(line)));
    }

    Expected<void> write(const PointBatch& batch) override {
        blocks_.resize((batch.size() + exportBlockPoints - 1) / exportBlockPoints);
        inBlocks(batch.size(), [&](std::size_t block, std::size_t first, std::size_t end) {
            TextBuffer& text = blocks_[block];
            text.clear();
            for (std::size_t i = first; i < end; ++i) addLine(batch, i, text);
        });
        for (const TextBuffer& block : blocks_)
            if (auto ok = output_.write(block.bytes()); !ok) return ok;
        return {};
    }

    Expected<void> finish(const PointSurvey&) override { return output_.finish(); }
    std::uint64_t bytesWritten() const override { return output_.bytesWritten(); }
    std::vector<std::string> losses() const override {
        if (header_.crsWkt.empty() && !header_.crsEpsg) return {};
        return {"the coordinate reference system is not in the text, which has no place for it"};
    }

  private:
    void addLine(const PointBatch& batch, std::size_t i, TextBuffer& text) const {
        for (int a = 0; a < 3; ++a) {
            if (a > 0) text.character(separator_);
            addCoordinate(batch.position[i][a], a, text);
        }
        if (header_.attributes.color)
            for (int c = 0; c < 3; ++c)
                addWhole(batch.color.empty() ? 255 : batch.color[i][std::size_t(c)], text);
        if (header_.attributes.intensity) addWhole(batch.intensity.empty() ? 0 : batch.intensity[i], text);
        if (header_.attributes.classification)
            addWhole(batch.classification.empty() ? 0 : batch.classification[i], text);
        if (header_.attributes.normal)
            for (int a = 0; a < 3; ++a) {
                text.character(separator_);
                text.number(batch.normal.empty() ? 0.0f : batch.normal[i][a]);
            }
        for (const OutColumn& column : columns_) {
            text.character(separator_);
            addColumn(batch.rows.data() + i * stride_, column, text);
        }
        text.character('\n');
    }

    void addWhole(unsigned value, TextBuffer& text) const {
        text.character(separator_);
        text.number(value);
    }

    /// With the digits of the scan's grid; else as many as read back exactly.
    void addCoordinate(double value, int axis, TextBuffer& text) const {
        if (const auto& decimals = decimals_[std::size_t(axis)]) {
            const double step = header_.gridStep[axis], origin = header_.gridOrigin[axis];
            const double q = std::nearbyint((value - origin) / step);
            const bool onGrid = std::abs(origin + q * step - value) <= 1e-3 * step;
            const double most = 9e17 / double(std::abs(decimals->step));
            if (onGrid && std::abs(q) < most)
                return text.decimal(decimals->origin + decimals->step * std::int64_t(q), decimals->digits);
        }
        text.number(value);
    }

    static void addColumn(const std::byte* row, const OutColumn& column, TextBuffer& text) {
        const ColumnType type = column.column.type;
        const std::byte* at = row + column.at;
        if (column.decimals)
            return text.decimal(column.decimals->origin + column.decimals->step * storedWhole(at, type),
                                column.decimals->digits);
        if (column.scaled()) return text.number(valueOf(row, column));
        if (type == ColumnType::Uint64) return text.number(std::uint64_t(storedWhole(at, type)));
        if (isWhole(type)) return text.number(storedWhole(at, type));
        if (type == ColumnType::Float32) return text.number(float(storedNumber(at, type)));
        text.number(storedNumber(at, type));
    }

    OutputFile output_;
    ScanHeader header_;
    char separator_;
    std::vector<OutColumn> columns_;
    std::size_t stride_;
    std::array<std::optional<DecimalGrid>, 3> decimals_;
    std::vector<TextBuffer> blocks_;
};

}  // namespace

Expected<std::unique_ptr<ExportWriter>> createTextExport(OutputFile output, const ScanHeader& header,
                                                         char separator) {
    auto writer = std::make_unique<TextExport>(std::move(output), header, separator);
    if (auto ok = writer->begin(); !ok) return passOn(ok);
    return writer;
}

}  // namespace scancast
