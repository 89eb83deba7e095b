// Which system a map is asked in, and how that relates to the cloud's: by its name and the cloud's reference in the world.
// Pure functions of these; on the reference's thread. Pipeline: map request → **place** → map picture.
#pragma once

#include "renderer/geo/geo_reference.hpp"
#include "renderer/map/map_picture.hpp"
#include "server/net/maps/map_request.hpp"

namespace scancast {

struct MapPlacement {
    MapExtent extent;
    MapProjection projection;  ///< keeps a reference to `geo`
};

/// `geo` may be an error: where nothing of it is needed, it does not matter. Errors: that one; InvalidArgument (CRS).
Expected<MapPlacement> placementOf(const MapRequest& map, const Expected<GeoReference>& geo);

/// Whether only the reference can tell where it is: not where it is in the cloud's own coordinates by that name.
bool needsReference(const MapRequest& map);

}  // namespace scancast
