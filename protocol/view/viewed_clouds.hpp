// The clouds that a view shows together with its own (word `with`): overlaid epochs, tiles beside each other. Each is
// shifted, tinted or hidden by itself. In one coordinate system: the file's of the view's own cloud.
//
// Plain values; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scancast {

using Rgb8 = std::array<std::uint8_t, 3>;

/// What stands for the view's own cloud in the list, so that it can be shifted, tinted and hidden, too.
inline constexpr std::string_view ownCloudName = ".";

struct ViewedCloud {
    std::string cloud;    ///< its id at a server, its file for `scancast render`; or ownCloudName
    glm::dvec3 shift{0};  ///< added to all of its coordinates, file units
    std::optional<Rgb8>
        tint;  ///< multiplies its own colours; of a cloud without, and with color=cloud, it is the colour
    bool hidden = false;  ///< not drawn, and takes no part in anything else
    bool operator==(const ViewedCloud&) const = default;
};

/// In the order in which colours are dealt; the view's own cloud comes first where the list does not name it.
using ViewedClouds = std::vector<ViewedCloud>;
inline constexpr std::size_t mostViewedClouds = 64, longestCloudName = 255;

/// The colours of color=cloud, by place in the list, again and again: told apart by who sees fewer colours, too, and on dark
/// ground as on light.
inline constexpr std::array<Rgb8, 7> cloudColors{{{86, 180, 233},
                                                  {230, 159, 0},
                                                  {0, 158, 115},
                                                  {204, 121, 167},
                                                  {240, 228, 66},
                                                  {0, 114, 178},
                                                  {213, 94, 0}}};

}  // namespace scancast
