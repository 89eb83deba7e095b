#include "renderer/device/gl/context/egl_library.hpp"

#include <dlfcn.h>

#include <type_traits>

namespace scancast::gl {
namespace {

const char* eglErrorName(EGLint error) {
    switch (error) {
        case EGL_SUCCESS:
            return "no EGL error";
        case EGL_NOT_INITIALIZED:
            return "EGL_NOT_INITIALIZED";
        case EGL_BAD_ACCESS:
            return "EGL_BAD_ACCESS";
        case EGL_BAD_ALLOC:
            return "EGL_BAD_ALLOC";
        case EGL_BAD_ATTRIBUTE:
            return "EGL_BAD_ATTRIBUTE";
        case EGL_BAD_CONFIG:
            return "EGL_BAD_CONFIG";
        case EGL_BAD_CONTEXT:
            return "EGL_BAD_CONTEXT";
        case EGL_BAD_CURRENT_SURFACE:
            return "EGL_BAD_CURRENT_SURFACE";
        case EGL_BAD_DISPLAY:
            return "EGL_BAD_DISPLAY";
        case EGL_BAD_MATCH:
            return "EGL_BAD_MATCH";
        case EGL_BAD_NATIVE_PIXMAP:
            return "EGL_BAD_NATIVE_PIXMAP";
        case EGL_BAD_NATIVE_WINDOW:
            return "EGL_BAD_NATIVE_WINDOW";
        case EGL_BAD_PARAMETER:
            return "EGL_BAD_PARAMETER";
        case EGL_BAD_SURFACE:
            return "EGL_BAD_SURFACE";
        case EGL_BAD_DEVICE_EXT:
            return "EGL_BAD_DEVICE_EXT";
        case EGL_CONTEXT_LOST:
            return "EGL_CONTEXT_LOST";
        default:
            return "an unknown EGL error";
    }
}

Expected<EglFunctions> openEglLibrary() {
    void* const library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char* reason = dlerror();
        return fail(
            ErrorCode::DeviceUnavailable,
            std::string("dlopen of libEGL.so.1 failed: ").append(reason ? reason : "no reason given") +
                ". Install EGL (Debian: apt install libegl1 libgl1-mesa-dri) or use --backend=cpu.");
    }
    EglFunctions egl;
    egl.GetProcAddress = reinterpret_cast<PFNEGLGETPROCADDRESSPROC>(dlsym(library, "eglGetProcAddress"));
    if (!egl.GetProcAddress)
        return fail(
            ErrorCode::DeviceUnavailable,
            "libEGL.so.1 has no eglGetProcAddress: it is not an EGL library. Reinstall it (Debian: apt "
            "install --reinstall libegl1).");
    // EGL before 1.5 gives only extensions by eglGetProcAddress, so core functions are asked of the library
    // first.
    std::string missing;
    const auto load = [&](auto& function, const char* name, bool required) {
        void* symbol = dlsym(library, name);
        if (!symbol) symbol = reinterpret_cast<void*>(egl.GetProcAddress(name));
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(symbol);
        if (!function && required) missing = name;
    };
    load(egl.GetError, "eglGetError", true);
    load(egl.QueryString, "eglQueryString", true);
    load(egl.Initialize, "eglInitialize", true);
    load(egl.BindAPI, "eglBindAPI", true);
    load(egl.CreateContext, "eglCreateContext", true);
    load(egl.DestroyContext, "eglDestroyContext", true);
    load(egl.MakeCurrent, "eglMakeCurrent", true);
    if (!missing.empty())
        return fail(ErrorCode::DeviceUnavailable, "libEGL.so.1 has no " + missing + "; EGL 1.4 is needed.");

    const char* const client = egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (listsExtension(client, "EGL_EXT_platform_base"))
        load(egl.GetPlatformDisplay, "eglGetPlatformDisplayEXT", false);
    if (listsExtension(client, "EGL_EXT_device_base") || listsExtension(client, "EGL_EXT_device_enumeration"))
        load(egl.QueryDevices, "eglQueryDevicesEXT", false);
    if (listsExtension(client, "EGL_EXT_device_base") || listsExtension(client, "EGL_EXT_device_query"))
        load(egl.QueryDeviceString, "eglQueryDeviceStringEXT", false);
    return egl;
}

}  // namespace

Expected<const EglFunctions*> eglLibrary() {
    static const Expected<EglFunctions> library = openEglLibrary();
    if (!library) return passOn(library);
    return &*library;
}

tl::unexpected<Error> eglFailure(const EglFunctions& egl, const std::string& call, const std::string& hint) {
    return fail(ErrorCode::DeviceUnavailable,
                call + " failed with " + eglErrorName(egl.GetError()) + (hint.empty() ? "." : ". " + hint));
}

bool listsExtension(const char* list, std::string_view extension) {
    if (!list) return false;
    const std::string padded = std::string(" ").append(list).append(" ");
    return padded.find(std::string(" ").append(extension).append(" ")) != std::string::npos;
}

Expected<EGLDisplay> openDisplay(const EglFunctions& egl, EGLenum platform, void* native) {
    const bool surfaceless = platform == EGL_PLATFORM_SURFACELESS_MESA;
    const std::string call = surfaceless ? "eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA)"
                                         : "eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT)";
    const char* const extension = surfaceless ? "EGL_MESA_platform_surfaceless" : "EGL_EXT_platform_device";
    if (!egl.GetPlatformDisplay ||
        !listsExtension(egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), extension))
        return fail(ErrorCode::DeviceUnavailable,
                    call + " is not offered: libEGL lacks " + extension + ". " + driverHint);

    const EGLDisplay display = egl.GetPlatformDisplay(platform, native, nullptr);
    if (display == EGL_NO_DISPLAY) return eglFailure(egl, call, driverHint);
    // Initialising a display again does nothing.
    if (!egl.Initialize(display, nullptr, nullptr))
        return eglFailure(egl, "eglInitialize after " + call,
                          std::string("Its driver could not start. ") + driverHint);
    return display;
}

}  // namespace scancast::gl
