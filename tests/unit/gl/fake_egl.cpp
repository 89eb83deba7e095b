// A libEGL.so.1 that goes wrong where it is told to: FAKE_EGL="eglInitialize 0x3001" makes that call fail
// with that error. Everything before it works, so that tests reach every call of ours.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstdlib>
#include <cstring>

namespace {

EGLint lastError = EGL_SUCCESS;

/// Whether this call is the one that fails.
bool fails(const char* call) {
    const char* const told = std::getenv("FAKE_EGL");
    const std::size_t length = std::strlen(call);
    if (!told || std::strncmp(told, call, length) != 0 || told[length] != ' ') return false;
    lastError = static_cast<EGLint>(std::strtol(told + length + 1, nullptr, 0));
    return true;
}

void* const someDevice = &lastError;
void* const someDisplay = &lastError;
void* const someContext = &lastError;

EGLBoolean queryDevices(EGLint most, EGLDeviceEXT* devices, EGLint* count) {
    if (fails("eglQueryDevicesEXT")) return EGL_FALSE;
    *count = fails("no-device") ? 0 : 1;
    if (most > 0 && *count > 0) devices[0] = someDevice;
    return EGL_TRUE;
}

const char* queryDeviceString(EGLDeviceEXT, EGLint name) {
    if (name == EGL_EXTENSIONS) return "EGL_EXT_device_drm EGL_EXT_device_drm_render_node";
    if (name == EGL_DRM_RENDER_NODE_FILE_EXT) return "/dev/dri/renderD128";
    return name == EGL_DRM_DEVICE_FILE_EXT ? "/dev/dri/card0" : nullptr;
}

EGLDisplay getPlatformDisplay(EGLenum, void*, const EGLint*) {
    return fails("eglGetPlatformDisplayEXT") ? EGL_NO_DISPLAY : someDisplay;
}

}  // namespace

extern "C" {

EGLint eglGetError() {
    const EGLint error = lastError;
    lastError = EGL_SUCCESS;
    return error;
}

const char* eglQueryString(EGLDisplay display, EGLint) {
    if (display == EGL_NO_DISPLAY)
        return fails("no-device-extensions")
                   ? "EGL_EXT_platform_base"
                   : "EGL_EXT_platform_base EGL_EXT_device_base EGL_EXT_platform_device";
    return fails("no-surfaceless") ? "EGL_KHR_create_context"
                                   : "EGL_KHR_create_context EGL_KHR_surfaceless_context "
                                     "EGL_KHR_no_config_context";
}

EGLBoolean eglInitialize(EGLDisplay, EGLint*, EGLint*) {
    return !fails("eglInitialize");
}
EGLBoolean eglBindAPI(EGLenum) {
    return !fails("eglBindAPI");
}
EGLContext eglCreateContext(EGLDisplay, EGLConfig, EGLContext, const EGLint* attributes) {
    // Drivers without robustness take none of its attributes.
    for (const EGLint* a = attributes; *a != EGL_NONE; a += 2) {
        const bool robust =
            a[0] == EGL_CONTEXT_FLAGS_KHR && (a[1] & EGL_CONTEXT_OPENGL_ROBUST_ACCESS_BIT_KHR);
        if (robust && fails("no-robust-access")) return EGL_NO_CONTEXT;
        const bool tellsResets = a[0] == EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_KHR;
        if ((robust || tellsResets) && fails("no-robustness")) return EGL_NO_CONTEXT;
    }
    return fails("eglCreateContext") ? EGL_NO_CONTEXT : someContext;
}
EGLBoolean eglDestroyContext(EGLDisplay, EGLContext) {
    return EGL_TRUE;
}
EGLBoolean eglMakeCurrent(EGLDisplay, EGLSurface, EGLSurface, EGLContext context) {
    return context == EGL_NO_CONTEXT || !fails("eglMakeCurrent");
}

__eglMustCastToProperFunctionPointerType eglGetProcAddress(const char* name) {
    using Function = __eglMustCastToProperFunctionPointerType;
    if (std::strcmp(name, "eglQueryDevicesEXT") == 0) return reinterpret_cast<Function>(&queryDevices);
    if (std::strcmp(name, "eglQueryDeviceStringEXT") == 0)
        return reinterpret_cast<Function>(&queryDeviceString);
    if (std::strcmp(name, "eglGetPlatformDisplayEXT") == 0)
        return reinterpret_cast<Function>(&getPlatformDisplay);
    return nullptr;  // no OpenGL in here
}

}  // extern "C"
