// libEGL, opened at run time: the functions that this room calls, its errors by name, and displays that are
// closed when the last context on them goes. Any thread.
#pragma once

#define EGL_NO_PLATFORM_SPECIFIC_TYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast::gl {

struct EglFunctions {
    PFNEGLGETPROCADDRESSPROC GetProcAddress = nullptr;
    PFNEGLGETERRORPROC GetError = nullptr;
    PFNEGLQUERYSTRINGPROC QueryString = nullptr;
    PFNEGLINITIALIZEPROC Initialize = nullptr;
    PFNEGLBINDAPIPROC BindAPI = nullptr;
    PFNEGLCREATECONTEXTPROC CreateContext = nullptr;
    PFNEGLDESTROYCONTEXTPROC DestroyContext = nullptr;
    PFNEGLMAKECURRENTPROC MakeCurrent = nullptr;
    // Extensions; null where libEGL lacks them.
    PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplay = nullptr;
    PFNEGLQUERYDEVICESEXTPROC QueryDevices = nullptr;
    PFNEGLQUERYDEVICESTRINGEXTPROC QueryDeviceString = nullptr;
};

/// The process's libEGL. DeviceUnavailable says what to install.
Expected<const EglFunctions*> eglLibrary();

/// What to install, or to give a container, when no driver does what was asked of it.
inline constexpr const char* driverHint =
    "Install a driver (Debian: apt install libegl-mesa0 libgl1-mesa-dri; for NVIDIA its own), or give the "
    "container its GPU: for NVIDIA the NVIDIA container runtime with "
    "NVIDIA_DRIVER_CAPABILITIES=graphics,utility, for others /dev/dri.";

/// DeviceUnavailable: "CALL failed with EGL_BAD_ALLOC. HINT"; reads the thread's last EGL error.
tl::unexpected<Error> eglFailure(const EglFunctions& egl, const std::string& call, const std::string& hint);

/// Whether a space-separated list names the extension.
bool listsExtension(const char* list, std::string_view extension);

/// An initialised display; `platform` is EGL_PLATFORM_DEVICE_EXT with a device, or
/// EGL_PLATFORM_SURFACELESS_MESA with nullptr. Never terminated: EGL has one display per device for the whole
/// process, so one user's end would be everybody's, and terminating the last unloads the driver, which
/// drivers do not survive well.
Expected<EGLDisplay> openDisplay(const EglFunctions& egl, EGLenum platform, void* native);

}  // namespace scancast::gl
