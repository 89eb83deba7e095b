// What shaders are given of a splat pass, a run and a layer, packed from the host's numbers. Pure functions;
// any thread. Place: splat passes, runs → **parameters** → layer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/device/gl/programs/splat_layouts.hpp"
#include "renderer/device/host/colors.hpp"
#include "renderer/device/host/splats.hpp"

namespace scancast::gl {

/// `area`: the pixels that are drawn; `index`: of the pass in its list.
SplatParams splatParams(const SplatPass& numbers, ivec4 area, std::size_t index, bool byClass);
/// Rows of background begin `firstRow` rows above the area.
ResolveParams resolveParams(const SplatPass& numbers, ivec4 area, ivec4 planes, int backgroundRow);
SmoothParams smoothParams(const SplatPass& numbers, ivec4 planes);

/// What samples look up (shaders/splat_tables.glsl), and what is known of the runs that refer to it, wherever they are
/// seen from.
struct SplatTables {
    std::vector<std::uint32_t> words;
    std::vector<RunFacts> runs;
    bool filters = false;  ///< some of the runs' samples are not drawn

    /// Forgets all runs; what memory there is stays, for as many as these.
    void begin(const ColorTables& colors, std::size_t mostRuns);
    /// The run's index in `runs`.
    std::uint32_t add(const Node& node, const RunNumbers& run, const RunRegions& crossing);
};

}  // namespace scancast::gl
