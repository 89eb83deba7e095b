// A view as JSON (PROTOCOL.md, "A view as JSON"): what a WebSocket `view` message and a POSTed snapshot
// carry, and the canonical form that ETags are made of.
//
// Pure functions without state; any thread. Pipeline: parseJson → **applyJson** → the view that is rendered.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "protocol/view/view.hpp"

namespace scancast {

/// `base` with the given fields changed; `base` itself stays. Rules for a subset:
///  - what is not given keeps the value of `base`; null puts a field back to its default where it has an
///  automatic one;
///  - eye, target or up end the use of a viewMatrix, and the other way round; both in one object are an
///  error;
///  - `method` starts from that method's defaults: the base's parameters are dropped. `param` alone adds to
///  them, and
///    null removes one.
/// Errors: InvalidArgument whose field is the JSON path ("camera.fov"), for unknown fields, wrong types and
/// values out of range; ImpossibleView as validate() says it.
Expected<View> applyJson(const View& base, const nlohmann::json& changes);

/// Every field that decides the picture and none that does not (no fov in an orthographic camera), so that
/// views of the same picture print the same. applyJson(anything, toJson(v)) shows the picture of v.
nlohmann::json toJson(const View& view);

}  // namespace scancast
