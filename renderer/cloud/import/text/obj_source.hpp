// Reads the vertices of a Wavefront OBJ as points, front to back through one bounded buffer.
// Pipeline: bytes → lines → **vertices** → points → octree. Owned and used by one thread.
//
// A vertex is a line "v x y z [w] [red green blue]"; a backslash at the end of a line joins the next one to it. Normals belong to
// corners of faces there, not to vertices, so they are left out like everything else, and counted in notes().
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/text/text_lines.hpp"
#include "renderer/cloud/import/text/text_values.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// Could these first bytes be an OBJ? All lines but comments begin with words of OBJ, and there is a vertex; under the name
/// .obj comments alone, or words without a vertex yet, do.
bool looksLikeObj(std::string_view start, bool named);

class ObjSource final : public PointSource {
  public:
    /// `bytes` stands at the start of the file; `name` is what messages call it. Errors: Malformed, Empty, Unsupported (UTF-16),
    /// Io.
    static Expected<std::unique_ptr<ObjSource>> create(std::unique_ptr<ByteSource> bytes, std::string name);

    const ScanHeader& header() const override { return scan_; }
    /// Errors: also Empty for a file without a vertex.
    Expected<bool> read(PointBatch& batch) override;
    std::uint64_t droppedPoints() const override { return dropped_; }
    std::vector<std::string> notes() const override;
    std::array<std::uint64_t, 2> bytesRead() const override {
        return {lines_.bytesTaken(), lines_.bytesTotal()};
    }

  private:
    ObjSource(TextLines lines, std::string name) : lines_(std::move(lines)), name_(std::move(name)) {}

    Expected<void> findColors();
    Expected<bool> nextLine(std::string_view& line);
    Expected<void> addVertex(std::string_view numbers, PointBatch& batch);
    Expected<void> endOfFile() const;

    TextLines lines_;
    std::string name_;
    ScanHeader scan_;
    ColorScale colorScale_ = ColorScale::Unit;
    std::string joined_;  ///< lines that are continued
    std::uint64_t vertices_ = 0, dropped_ = 0, withoutColor_ = 0, badColors_ = 0, colorsLeftOut_ = 0;
    std::uint64_t faces_ = 0, normals_ = 0, textures_ = 0, others_ = 0;
};

}  // namespace scancast
