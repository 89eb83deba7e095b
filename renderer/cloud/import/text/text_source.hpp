// Reads a text of points - XYZ, TXT, CSV, PTS - front to back through one bounded buffer.
// Pipeline: bytes → lines → rows → **points** → octree. Owned and used by one thread.
//
// A line is a point. What the columns mean is found out from a header or from the numbers (text_columns.hpp);
// a line that holds only a whole number is the count of points that follow, and starts the next scan of a
// PTS.
#pragma once

#include <memory>
#include <string>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/text/text_lines.hpp"
#include "renderer/cloud/import/text/text_row.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct TextOptions {
    bool pts = false;             ///< the name says PTS: intensities are −2048…2047
    bool keepAttributes = false;  ///< keep columns of numbers that do not fit the sample
    bool recover = false;         ///< of a text that ends too early, read the lines that are whole
};

class TextSource final : public PointSource {
  public:
    /// `bytes` stands at the start of the file; `name` is what messages call it. Errors: Malformed, Empty,
    /// Unsupported (UTF-16), Io.
    static Expected<std::unique_ptr<TextSource>> create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                        const TextOptions& options = {});

    const ScanHeader& header() const override { return scan_; }
    Expected<bool> read(PointBatch& batch) override;
    std::uint64_t droppedPoints() const override { return dropped_; }
    std::vector<std::string> notes() const override { return notes_; }
    std::array<std::uint64_t, 2> bytesRead() const override {
        return {lines_.bytesTaken(), lines_.bytesTotal()};
    }

  private:
    TextSource(TextLines lines, std::string name, TextRow row)
        : lines_(std::move(lines)), name_(std::move(name)), row_(std::move(row)) {}

    Expected<void> startScan(std::uint64_t points);
    Expected<void> finishScan();

    TextLines lines_;
    std::string name_;
    TextRow row_;
    ScanHeader scan_;
    bool counted_ = false;        ///< lines with counts are part of this text
    std::uint64_t promised_ = 0;  ///< by the last count
    std::uint64_t inScan_ = 0;    ///< points since the last count
    std::uint64_t points_ = 0;
    std::uint64_t dropped_ = 0;
    bool recover_ = false;
    std::vector<std::string> notes_;  ///< on what is lost
};

}  // namespace scancast
