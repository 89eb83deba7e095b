// Blocks of one scan's columns → points in file coordinates, in batches of the point stream. Owned and used by one thread.
// Pipeline: columns → **points** → point stream.
#pragma once

#include <cstdint>

#include "importers/e57/import_plan.hpp"
#include "importers/e57/record_reader.hpp"

namespace scancast::import_e57 {

/// Over all scans of a file.
struct Counts {
    std::uint64_t marked = 0;     ///< left out: the scanner says that there is no point
    std::uint64_t notFinite = 0;  ///< left out: a coordinate is NaN or infinite
    std::uint64_t colorless = 0;  ///< their colour is not valid: black
    std::uint64_t intensityless = 0;
};

class ScanConverter {
  public:
    /// All must outlive it. `number`: the scan's, from 1.
    ScanConverter(const ScanDescription& scan, const ImportPlan& plan, std::size_t number, Counts& counts);

    /// Appends the reader's last block to `batch`.
    void append(const RecordReader& reader, PointBatch& batch);

  private:
    std::span<const double> of(const RecordReader& reader, Role role) const {
        return reader.column(scan_.fieldOf[role]);
    }
    void appendPositions(const RecordReader& reader, PointBatch& batch) const;
    void findPositions(const RecordReader& reader, std::size_t count);
    void appendColors(const RecordReader& reader, PointBatch& batch);
    void appendNormals(const RecordReader& reader, PointBatch& batch) const;
    void appendRows(const RecordReader& reader, PointBatch& batch) const;

    const ScanDescription& scan_;
    const ImportPlan& plan_;
    std::size_t number_;
    Counts& counts_;
    Scale intensity_;
    std::array<Scale, 3> color_;
    std::vector<int> keptField_;  ///< for each kept column the scan's field, or -1
    std::size_t rowBytes_ = 0;
    std::vector<glm::dvec3> positions_;  ///< of the block
    std::vector<std::uint32_t> kept_;    ///< records of the block that are points
};

}  // namespace scancast::import_e57
