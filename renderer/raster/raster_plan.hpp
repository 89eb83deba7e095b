// What a request for a raster means for one cloud, checked before anything is made: its grid, which points count, how it is seen.
// Immutable. Pure functions; any thread. Pipeline: request + cloud → **plan** → elevation or orthophoto → TIFF.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "renderer/raster/elevation.hpp"
#include "renderer/raster/ortho_view.hpp"
#include "renderer/raster/raster_tiff.hpp"

namespace scancast {

struct PlannedRaster {
    RasterLayout layout{};  ///< but for its keys
    ElevationOptions elevation{};
    SampleFilter filter{};  ///< of elevation
    /// Of elevation whose view asks for values of columns: the cloud with what these leave. Null: the cloud itself.
    std::shared_ptr<const Cloud> pictured{};
    std::optional<OrthoViews> ortho{};  ///< of an orthophoto
    /// Everything that the file depends on beside the cloud (and, of an orthophoto, the device), as text.
    std::string identity{};
};

/// Errors: rasterGrid()'s; those of the view's words and of plan().
Expected<PlannedRaster> planRaster(const Cloud& cloud, const RasterRequest& request,
                                   const RasterLimits& limits = {});

/// The file that it becomes, with the cloud's place on earth. Where a CRS has no number, PROJ is asked, which takes a tenth of a second:
/// not for threads that others wait for. Errors: RasterTiff::create()'s.
Expected<std::unique_ptr<RasterTiff>> openTiff(const Cloud& cloud, const PlannedRaster& raster,
                                               const RasterScratch& scratch);

/// Its cells of a window; of elevation rasters. As elevationOf().
Expected<std::vector<std::byte>> elevationCells(const Cloud& cloud, const PlannedRaster& raster,
                                                const CellWindow& block, const std::stop_token& stop = {});

}  // namespace scancast
