// Reads a PTX file - gridded scans, each with the scanner's place and a matrix - front to back through one
// bounded buffer. Pipeline: bytes → lines → rows → **points** → octree. Owned and used by one thread.
//
// A scan is: number of columns, number of rows, the scanner's position, its three axes, a 4 × 4 matrix of row
// vectors (translation last), then columns × rows points: x y z [intensity] [red green blue]. Points come out
// transformed, in double precision; a direction without an echo is the point 0 0 0 and is dropped. No batch holds points of two scans: each
// says where its scanner stood.
#pragma once

#include <array>
#include <glm/mat4x3.hpp>
#include <memory>
#include <string>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/text/text_lines.hpp"
#include "renderer/cloud/import/text/text_row.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class PtxSource final : public PointSource {
  public:
    /// `bytes` stands at the start of the file; `name` is what messages call it. Errors: Malformed,
    /// Truncated, Unsupported (UTF-16), Io.
    /// `recover`: of a text that ends too early, the lines that are whole are all, and a note tells of the rest.
    static Expected<std::unique_ptr<PtxSource>> create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                       bool recover = false);

    /// The scanner's place is told where the file seems to hold one scan (judged by its length), and
    /// forgotten when a second one is met all the same: then no one place explains all points.
    const ScanHeader& header() const override { return scan_; }
    Expected<bool> read(PointBatch& batch) override;
    std::vector<Station> stations() const override { return ended_ ? stations_ : std::vector<Station>(); }
    /// Directions without an echo among them.
    std::uint64_t droppedPoints() const override { return dropped_; }
    std::vector<std::string> notes() const override { return notes_; }
    std::array<std::uint64_t, 2> bytesRead() const override {
        return {lines_.bytesTaken(), lines_.bytesTotal()};
    }

  private:
    PtxSource(TextLines lines, std::string name, TextRow row)
        : lines_(std::move(lines)), name_(std::move(name)), row_(std::move(row)) {}

    Expected<bool> startScan();
    Expected<bool> startNextScan();
    Expected<bool> nextLine(std::string_view& line);
    Expected<std::string_view> headLine(const char* what);
    Expected<std::uint64_t> headCount(const char* what);
    Expected<void> headNumbers(const char* what, std::span<double> numbers);

    TextLines lines_;
    std::string name_;
    TextRow row_;
    ScanHeader scan_;
    std::vector<Station> stations_;  ///< of the scans begun
    glm::dmat4x3 transform_{1};      ///< of column vectors, as glm has them
    bool ended_ = false;
    std::uint64_t promised_ = 0;  ///< points of this scan
    std::uint64_t inScan_ = 0;    ///< of them, read
    std::uint64_t scans_ = 0;
    std::uint64_t points_ = 0;
    std::uint64_t dropped_ = 0;
    bool recover_ = false;
    std::vector<std::string> notes_;  ///< on what is lost
};

}  // namespace scancast
