// What the columns of a text of points mean: by their names where a header gives them, else by their number
// and the range of their values. Pure functions.
// Pipeline: bytes → lines → **columns** → rows → points.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/import/text/text_fields.hpp"
#include "renderer/cloud/import/text/text_head.hpp"
#include "renderer/cloud/import/text/text_values.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

struct TextLayout {
    static constexpr int none = -1;

    Separator separator;
    std::size_t columns = 0;
    std::array<int, 3> position{none, none, none};
    std::array<int, 3> color{none, none, none};
    std::array<int, 3> normal{none, none, none};
    int intensity = none;
    int classification = none;
    std::vector<std::string> names;  ///< of all columns, by the header; empty = there is none
    std::vector<int> spare;          ///< columns of numbers that are none of the above
    ColorScale colorScale = ColorScale::Byte;
    IntensityScale intensityScale = IntensityScale::Plain;

    Attributes attributes() const {
        return {color[0] != none, intensity != none, classification != none, normal[0] != none};
    }
    /// "x y z red green blue", in the order of the file; '-' for those that are left out.
    std::string describe() const;
};

/// More columns than any scan has.
inline constexpr std::size_t mostTextColumns = 256;

/// `lines` are lines of points, the first one and more from all over the file; comments among them are passed
/// over. `pts`: see intensityScale(). `name` is what messages call the file. Errors: Malformed, Empty.
Expected<TextLayout> understandColumns(const TextHead& head, std::span<const std::string_view> lines,
                                       bool pts, const std::string& name);

}  // namespace scancast
