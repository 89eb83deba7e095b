// A camera that flies through key frames, smoothly. Pure functions; any thread.
//
// The file (`scancast-client path`, example/flight.json), lengths in the cloud's unit, times in seconds:
//
//     {"view": {"method": "disc"},
//      "keys": [{"time": 0, "camera": {"eye": [0, -50, 20], "target": [0, 0, 0]}},
//               {"time": 4, "camera": {"eye": [50, 0, 20]}},
//               {"time": 6, "camera": {"target": [0, 0, 10], "fov": 40}}]}
//
// `view` is any subset of a view as JSON (PROTOCOL.md), on top of the cloud's default view. A key's `camera`
// is any subset of a camera; what is not given is as in the key before. Times grow; without any, keys are one
// second apart. Unknown fields are errors.
#pragma once

#include <string_view>
#include <vector>

#include "protocol/view/view.hpp"

namespace scancast::client {

struct CameraKey {
    double time = 0;  ///< seconds
    Camera camera;    ///< without a viewMatrix
    bool operator==(const CameraKey&) const = default;
};

struct CameraPath {
    View view;                    ///< everything but the camera
    std::vector<CameraKey> keys;  ///< two or more, times growing, all of one projection

    double begin() const { return keys.front().time; }
    double seconds() const { return keys.back().time - keys.front().time; }
    /// Eye, target and up run along cubics through the keys whose speed does not jump (Catmull-Rom for times
    /// that need not be even); fov, height, near and far go evenly between neighbours. Exact at the keys;
    /// times outside are clamped.
    View at(double time) const;
};

/// `base` is what the file's `view` changes. Malformed for what is no JSON; InvalidArgument, with the JSON
/// path ("keys[2].camera.fov") as field, or ImpossibleView, for everything else.
Expected<CameraPath> parseCameraPath(std::string_view json, const View& base);

}  // namespace scancast::client
