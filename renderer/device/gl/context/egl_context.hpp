// OpenGL without a window system by EGL: a device of the platform "device" (every GPU has one, and Mesa's
// software rasteriser), else Mesa's surfaceless platform. libEGL is opened at run time, once, and stays open
// until the process ends: drivers do not survive being unloaded.
//
// Listing is callable from any thread; a context belongs to the thread that created it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/device/gl/context/gl_context.hpp"

namespace scancast::gl {

struct EglDevice {
    int index = -1;         ///< what --egl-device calls it; -1 = not listed
    bool software = false;  ///< says of itself that it is Mesa's rasteriser on the CPU
    std::string node;       ///< "/dev/dri/renderD128"; empty = unknown
};

/// In EGL's own order. DeviceUnavailable when libEGL is missing, cannot enumerate, or finds none.
Expected<std::vector<EglDevice>> listEglDevices();

/// `device` as listed; -1 = hardware before software, then the surfaceless platform. DeviceUnavailable names
/// every call that failed, its EGL error, and what to install or mount.
Expected<std::unique_ptr<Context>> createEglContext(int device = -1);

}  // namespace scancast::gl
