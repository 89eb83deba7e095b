#include "renderer/device/gl/context/osmesa_context.hpp"

#include <dlfcn.h>

#include <array>
#include <string>

namespace scancast::gl {
namespace {

// Of GL/osmesa.h, which drags in another OpenGL header than ours.
constexpr int osmesaFormat = 0x22, osmesaDepthBits = 0x30, osmesaStencilBits = 0x31, osmesaAccumBits = 0x32;
constexpr int osmesaProfile = 0x33, osmesaCoreProfile = 0x34;
constexpr int osmesaMajorVersion = 0x36, osmesaMinorVersion = 0x37;

struct OsmesaFunctions {
    void* (*CreateContextAttribs)(const int* attributes, void* share) = nullptr;
    void (*DestroyContext)(void* context) = nullptr;
    GLboolean (*MakeCurrent)(void* context, void* buffer, GLenum type, GLsizei width,
                             GLsizei height) = nullptr;
    GetProcAddress getProcAddress = nullptr;
};

Expected<OsmesaFunctions> openOsmesaLibrary() {
    void* const library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char* reason = dlerror();
        return fail(
            ErrorCode::DeviceUnavailable,
            std::string("dlopen of libOSMesa.so.8 failed: ").append(reason ? reason : "no reason given") +
                ". Install OSMesa (Debian 12: apt install libosmesa6; Mesa from 25.1 on has none) or use "
                "--backend=egl or --backend=cpu.");
    }
    OsmesaFunctions osmesa;
    std::string missing;
    const auto load = [&](auto& function, const char* name) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
        if (!function) missing = name;
    };
    load(osmesa.CreateContextAttribs, "OSMesaCreateContextAttribs");
    load(osmesa.DestroyContext, "OSMesaDestroyContext");
    load(osmesa.MakeCurrent, "OSMesaMakeCurrent");
    load(osmesa.getProcAddress, "OSMesaGetProcAddress");
    if (!missing.empty())
        return fail(ErrorCode::DeviceUnavailable,
                    "libOSMesa.so.8 has no " + missing + ": Mesa 12 or newer is needed.");
    return osmesa;
}

Expected<const OsmesaFunctions*> osmesaLibrary() {
    static const Expected<OsmesaFunctions> library = openOsmesaLibrary();
    if (!library) return passOn(library);
    return &*library;
}

class OsmesaContext final : public Context {
  public:
    OsmesaContext(const OsmesaFunctions& osmesa, void* context) : osmesa_(osmesa), context_(context) {}
    ~OsmesaContext() override { osmesa_.DestroyContext(context_); }

    const char* backend() const override { return "osmesa"; }

    Expected<void> load() {
        auto current = Current::enter(*this);
        if (!current) return passOn(current);
        auto functions = loadFunctions(osmesa_.getProcAddress);
        if (!functions) return passOn(functions);
        functions_ = *functions;
        return {};
    }

  protected:
    Expected<void> makeCurrent() override {
        if (!osmesa_.MakeCurrent(context_, surface_.data(), GL_UNSIGNED_BYTE, surfaceSide, surfaceSide))
            return fail(ErrorCode::DeviceLost, "OSMesaMakeCurrent failed; it gives no reason.");
        return {};
    }
    void release() override { osmesa_.MakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

  private:
    static constexpr int surfaceSide = 16;

    const OsmesaFunctions& osmesa_;
    void* context_;
    /// OSMesa insists on a picture to draw into; compute shaders never do.
    std::array<unsigned char, surfaceSide * surfaceSide * 4> surface_{};
};

}  // namespace

Expected<std::unique_ptr<Context>> createOsmesaContext() {
    const auto osmesa = osmesaLibrary();
    if (!osmesa) return passOn(osmesa);
    constexpr int attributes[] = {osmesaFormat,
                                  GL_RGBA,
                                  osmesaDepthBits,
                                  0,
                                  osmesaStencilBits,
                                  0,
                                  osmesaAccumBits,
                                  0,
                                  osmesaProfile,
                                  osmesaCoreProfile,
                                  osmesaMajorVersion,
                                  4,
                                  osmesaMinorVersion,
                                  5,
                                  0};
    void* const context = (*osmesa)->CreateContextAttribs(attributes, nullptr);
    if (!context)
        return fail(
            ErrorCode::DeviceUnavailable,
            "OSMesaCreateContextAttribs(OpenGL 4.5 core) failed; it gives no reason. Mesa older than 20 has "
            "less than OpenGL 4.5 here: update libosmesa6.");
    auto made = std::make_unique<OsmesaContext>(**osmesa, context);
    if (auto ok = made->load(); !ok) return passOn(ok);
    return made;
}

}  // namespace scancast::gl
