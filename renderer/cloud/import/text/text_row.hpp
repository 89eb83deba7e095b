// One line of a text of points, checked and added to a batch: the inner loop of reading text.
// Pipeline: bytes → lines → **rows** → points. Owned and used by one reader, on its thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/import/text/text_columns.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class TextRow {
  public:
    /// `keep`: the layout's spare columns are kept, too (see keptTextColumns()).
    TextRow(TextLayout layout, bool keep);

    /// Takes the line's numbers apart. nullptr, or why not: the end of a sentence, kept until the next call.
    const std::string* parse(std::string_view line);
    glm::dvec3 position() const { return position_; }
    bool finite() const;
    /// Adds the parsed point, at `position`. nullptr, or why not.
    const std::string* appendTo(PointBatch& batch, const glm::dvec3& position);

    const TextLayout& layout() const { return layout_; }

  private:
    const std::string* badField(std::size_t column, const char* at, const char* end);
    const std::string* badCount(std::string_view line);
    const std::string* badColor(int column);
    double value(int column) const { return values_[static_cast<std::size_t>(column)]; }

    TextLayout layout_;
    bool keep_;
    std::vector<std::uint8_t> wanted_;  ///< by column: its number is read
    std::vector<double> values_;
    glm::dvec3 position_{0};
    std::string comma_;  ///< a line whose decimal commas became points
    std::string why_;
};

/// The spare columns of a layout, as they are kept: their own names, numbers of 64 bits.
std::vector<Column> keptTextColumns(const TextLayout& layout);

}  // namespace scancast
