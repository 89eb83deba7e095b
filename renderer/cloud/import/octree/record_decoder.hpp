// Records of points to the columns of a batch: the inner loop of importing an octree. Two kinds: records of an octree's
// own layout, and records of LAS. Const functions of bytes; any thread. Pipeline: bytes → **records** → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "renderer/cloud/import/las/las_columns.hpp"
#include "renderer/cloud/import/las/las_decode.hpp"
#include "renderer/cloud/import/octree/point_layout.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_octree {

/// Points, and what was lost on the way: told at the end of the scan.
struct DecodedPoints {
    PointBatch batch;
    std::uint64_t dropped = 0;  ///< a coordinate was NaN or infinite
    std::uint64_t outside = 0;  ///< numbers that a sample has no room for: brought to 0-65535, classes to 0
};

class RecordDecoder {
  public:
    virtual ~RecordDecoder() = default;
    virtual std::uint32_t recordBytes() const = 0;
    /// What the colours of these records say of how they are meant; Unknown without colours.
    virtual LasColorDepth colorDepth(std::span<const std::byte> records) const = 0;
    virtual void decode(std::span<const std::byte> records, LasColorDepth depth, DecodedPoints& to) const = 0;
};

/// Where numbers of 1 stand for how far, and where 0 is; on top of what a field says of itself.
struct Grid {
    glm::dvec3 scale{1};
    glm::dvec3 offset{0};
};

class FieldDecoder final : public RecordDecoder {
  public:
    /// `layout` outlives it. `keep`: fill rows with layout.kept().
    FieldDecoder(const PointLayout& layout, const Grid& grid, bool keep)
        : layout_(layout), grid_(grid), keep_(keep) {}

    std::uint32_t recordBytes() const override { return layout_.bytes(); }
    LasColorDepth colorDepth(std::span<const std::byte> records) const override;
    /// Positions are steps where there is a grid().
    void decode(std::span<const std::byte> records, LasColorDepth depth, DecodedPoints& to) const override;
    /// Of positions that are whole numbers of 32 bits, all of which are coordinates.
    std::optional<StepGrid> grid() const;

  private:
    void decodePositions(const std::byte* records, std::size_t count, DecodedPoints& to) const;
    void decodeSteps(const std::byte* records, std::size_t count, const StepGrid& grid, Positions& to) const;
    void decodeColors(const std::byte* records, std::size_t count, LasColorDepth depth,
                      DecodedPoints& to) const;
    void decodeNormals(const std::byte* records, std::size_t count, std::vector<glm::vec3>& to) const;
    void decodeRows(const std::byte* records, std::size_t count, std::vector<std::byte>& to) const;

    const PointLayout& layout_;
    Grid grid_;
    bool keep_;
};

class LasDecoder final : public RecordDecoder {
  public:
    /// `columns`: those to keep.
    LasDecoder(const LasHeader& header, std::vector<LasColumn> columns)
        : header_(header), columns_(std::move(columns)) {}

    std::uint32_t recordBytes() const override { return header_.recordBytes; }
    LasColorDepth colorDepth(std::span<const std::byte> records) const override;
    void decode(std::span<const std::byte> records, LasColorDepth depth, DecodedPoints& to) const override;

    const LasHeader& header() const { return header_; }
    const std::vector<LasColumn>& columns() const { return columns_; }

  private:
    LasHeader header_;
    std::vector<LasColumn> columns_;
};

}  // namespace scancast::import_octree
