#include "renderer/device/gl/context/egl_context.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "renderer/device/gl/context/egl_library.hpp"

namespace scancast::gl {
namespace {

/// OpenGL 4.5 core, at best one that tells when the GPU was reset and keeps shaders inside their buffers
/// (EGL_KHR_create_context: what a driver does not offer is an error); EGL_NO_CONTEXT: none.
EGLContext createContext(const EglFunctions& egl, EGLDisplay display) {
    // Drivers check and tell more in a debug context, and some are slower for it.
    const EGLint debug = spdlog::should_log(spdlog::level::debug) ? EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR : 0;
    struct Robustness {
        EGLint access, notification;
    };
    for (const Robustness& wanted :
         {Robustness{EGL_CONTEXT_OPENGL_ROBUST_ACCESS_BIT_KHR, EGL_LOSE_CONTEXT_ON_RESET_KHR},
          Robustness{0, EGL_LOSE_CONTEXT_ON_RESET_KHR}, Robustness{0, EGL_NO_RESET_NOTIFICATION_KHR}}) {
        std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION_KHR,
                                       4,
                                       EGL_CONTEXT_MINOR_VERSION_KHR,
                                       5,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR,
                                       EGL_CONTEXT_FLAGS_KHR,
                                       debug | wanted.access};
        // The last try asks for nothing that an old driver may not know.
        if (wanted.notification != EGL_NO_RESET_NOTIFICATION_KHR) {
            attributes.push_back(EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_KHR);
            attributes.push_back(wanted.notification);
        }
        attributes.push_back(EGL_NONE);
        const EGLContext context =
            egl.CreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
        if (context != EGL_NO_CONTEXT) return context;
    }
    return EGL_NO_CONTEXT;
}

class EglContext final : public Context {
  public:
    static Expected<std::unique_ptr<Context>> create(const EglFunctions& egl, EGLenum platform,
                                                     void* native) {
        auto display = openDisplay(egl, platform, native);
        if (!display) return passOn(display);
        const EGLDisplay handle = *display;
        const char* const extensions = egl.QueryString(handle, EGL_EXTENSIONS);
        for (const char* needed :
             {"EGL_KHR_create_context", "EGL_KHR_surfaceless_context", "EGL_KHR_no_config_context"}) {
            if (!listsExtension(extensions, needed) &&
                !(std::string_view(needed) == "EGL_KHR_no_config_context" &&
                  listsExtension(extensions, "EGL_MESA_configless_context")))
                return fail(ErrorCode::DeviceUnavailable,
                            std::string("The EGL driver lacks ") + needed + ": it is too old. " + driverHint);
        }
        if (!egl.BindAPI(EGL_OPENGL_API))
            return eglFailure(
                egl, "eglBindAPI(EGL_OPENGL_API)",
                std::string("The driver has OpenGL ES only; desktop OpenGL 4.5 is needed. ") + driverHint);
        const EGLContext context = createContext(egl, handle);
        if (context == EGL_NO_CONTEXT)
            return eglFailure(
                egl, "eglCreateContext(OpenGL 4.5 core)",
                std::string("The driver is too old, or its OpenGL part is missing. ") + driverHint);
        std::unique_ptr<EglContext> made(new EglContext(egl, handle, context));
        auto current = Current::enter(*made);
        if (!current) return passOn(current);
        auto functions = loadFunctions(egl.GetProcAddress);
        if (!functions) return passOn(functions);
        made->functions_ = *functions;
        return made;
    }

    ~EglContext() override { egl_.DestroyContext(display_, context_); }

    const char* backend() const override { return "egl"; }

  protected:
    Expected<void> makeCurrent() override {
        egl_.BindAPI(EGL_OPENGL_API);
        if (!egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
            Error error = eglFailure(egl_, "eglMakeCurrent without a surface", driverHint).value();
            error.code = ErrorCode::DeviceLost;
            return tl::unexpected(std::move(error));
        }
        return {};
    }
    void release() override { egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

  private:
    EglContext(const EglFunctions& egl, EGLDisplay display, EGLContext context)
        : egl_(egl), display_(display), context_(context) {}

    const EglFunctions& egl_;
    EGLDisplay display_;
    EGLContext context_;
};

Expected<std::vector<EGLDeviceEXT>> deviceHandles(const EglFunctions& egl) {
    if (!egl.QueryDevices)
        return fail(
            ErrorCode::DeviceUnavailable,
            std::string("eglQueryDevicesEXT is not offered: libEGL found no driver that lists devices. ") +
                driverHint);
    EGLint count = 0;
    if (!egl.QueryDevices(0, nullptr, &count)) return eglFailure(egl, "eglQueryDevicesEXT", driverHint);
    std::vector<EGLDeviceEXT> handles(static_cast<std::size_t>(std::clamp(count, 0, 1024)));
    if (handles.empty())
        return fail(ErrorCode::DeviceUnavailable,
                    std::string("eglQueryDevicesEXT finds no device. ") + driverHint);
    if (!egl.QueryDevices(static_cast<EGLint>(handles.size()), handles.data(), &count))
        return eglFailure(egl, "eglQueryDevicesEXT", driverHint);
    handles.resize(static_cast<std::size_t>(std::clamp(count, 0, static_cast<EGLint>(handles.size()))));
    return handles;
}

EglDevice describe(const EglFunctions& egl, EGLDeviceEXT handle, int index) {
    EglDevice device;
    device.index = index;
    if (!egl.QueryDeviceString) return device;
    const char* const extensions = egl.QueryDeviceString(handle, EGL_EXTENSIONS);
    device.software = listsExtension(extensions, "EGL_MESA_device_software");
    // The render node is the one to open and to mount; every GPU has the other.
    const auto nodeBy = [&](const char* extension, EGLint name) {
        const char* const node =
            listsExtension(extensions, extension) ? egl.QueryDeviceString(handle, name) : nullptr;
        if (node && device.node.empty()) device.node = node;
    };
    nodeBy("EGL_EXT_device_drm_render_node", EGL_DRM_RENDER_NODE_FILE_EXT);
    nodeBy("EGL_EXT_device_drm", EGL_DRM_DEVICE_FILE_EXT);
    return device;
}

/// A device that does not open, and why a person would say it does not.
Expected<std::unique_ptr<Context>> openDevice(const EglFunctions& egl, EGLDeviceEXT handle, int index) {
    auto context = EglContext::create(egl, EGL_PLATFORM_DEVICE_EXT, handle);
    if (context) return context;
    const EglDevice device = describe(egl, handle, index);
    std::string& message = context.error().message;
    message.insert(
        0, fmt::format("EGL device {}{}: ", index, device.node.empty() ? "" : " (" + device.node + ")"));
    if (!device.node.empty() && ::access(device.node.c_str(), R_OK | W_OK) != 0)
        message += errno == EACCES ? " This user may not open " + device.node +
                                         ": add the user to the group that owns it (Debian: video, render)."
                                   : " There is no " + device.node + " here: give the container /dev/dri.";
    return context;
}

Expected<std::unique_ptr<Context>> createBest(const EglFunctions& egl) {
    std::string reasons;
    const auto handles = deviceHandles(egl);
    if (handles) {
        for (const bool software : {false, true}) {
            for (std::size_t i = 0; i < handles->size(); ++i) {
                if (describe(egl, (*handles)[i], static_cast<int>(i)).software != software) continue;
                auto context = openDevice(egl, (*handles)[i], static_cast<int>(i));
                if (context) return context;
                reasons += context.error().message + " ";
            }
        }
    } else {
        reasons = handles.error().message + " ";
    }
    auto context = EglContext::create(egl, EGL_PLATFORM_SURFACELESS_MESA, nullptr);
    if (context) return context;
    return fail(ErrorCode::DeviceUnavailable, reasons + "EGL without a device: " + context.error().message);
}

}  // namespace

Expected<std::vector<EglDevice>> listEglDevices() {
    const auto egl = eglLibrary();
    if (!egl) return passOn(egl);
    const auto handles = deviceHandles(**egl);
    if (!handles) return passOn(handles);
    std::vector<EglDevice> devices;
    for (std::size_t i = 0; i < handles->size(); ++i)
        devices.push_back(describe(**egl, (*handles)[i], static_cast<int>(i)));
    return devices;
}

Expected<std::unique_ptr<Context>> createEglContext(int device) {
    const auto egl = eglLibrary();
    if (!egl) return passOn(egl);
    if (device < 0) return createBest(**egl);
    const auto handles = deviceHandles(**egl);
    if (!handles) return passOn(handles);
    if (static_cast<std::size_t>(device) >= handles->size())
        return fail(ErrorCode::DeviceUnavailable,
                    fmt::format("There is no EGL device {}; EGL lists 0 to {} here. See --list-backends.",
                                device, handles->size() - 1),
                    "egl-device");
    return openDevice(**egl, (*handles)[static_cast<std::size_t>(device)], device);
}

}  // namespace scancast::gl
