// OpenGL in main memory by OSMesa, which needs no EGL, no device and no window system. Mesa has dropped
// OSMesa in 25.1: this file pair, its line in CMakeLists.txt and its mention in gl_device.cpp and device.cpp
// can go as one.
//
// libOSMesa is opened at run time, once, and stays open. A context belongs to the thread that created it.
#pragma once

#include <memory>

#include "renderer/device/gl/context/gl_context.hpp"

namespace scancast::gl {

/// DeviceUnavailable names the failed call and what to install.
Expected<std::unique_ptr<Context>> createOsmesaContext();

}  // namespace scancast::gl
