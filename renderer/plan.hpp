// What a view means for one cloud, looked up and checked: method, passes, camera, colours, and how to select.
// The part of render() that touches neither samples nor devices. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"
#include "renderer/select/select.hpp"
#include "renderer/select/viewpoint.hpp"

namespace scancast {

struct Plan {
    std::string method;
    std::string reason;  ///< why this method, where the view left that open
    PassList passes;
    Viewpoint viewpoint;
    ColorRule color;
    SelectOptions selection;
    int margin = 0;  ///< px around a tile that its screen passes look at
    /// None of them looks farther, so a picture has the same bytes in tiles as in one piece.
    bool tilesAreExact = true;
};

/// Errors: those of checkView() (renderer/render.hpp).
Expected<Plan> plan(const Cloud& cloud, const View& view);

/// As many samples as a picture may hold on to; nullopt = as many as there are.
std::optional<std::uint64_t> mostSamples(const Cloud& cloud);

}  // namespace scancast
