#include "video/openh264.hpp"

#include <dlfcn.h>
#include <wels/codec_api.h>
#include <wels/codec_ver.h>

namespace scancast {
namespace {

// The Debian package is named after the soname, as all are.
const char* const wayOut = "; apt install libopenh264-7 gives it to Debian and Ubuntu";

template <class Function>
bool findFunction(void* library, const char* symbol, Function*& function) {
    function = reinterpret_cast<Function*>(dlsym(library, symbol));
    return function != nullptr;
}

Expected<OpenH264> loadOpenH264() {
    // Never closed: what it made may live until the program ends.
    void* const library = dlopen(SCANCAST_OPENH264_SONAME, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
        return fail(ErrorCode::Unavailable, std::string("no H.264: ") + SCANCAST_OPENH264_SONAME +
                                                " is not on this machine" + wayOut);
    OpenH264 found;
    void (*version)(OpenH264Version*) = nullptr;
    if (!findFunction(library, "WelsGetCodecVersionEx", version) ||
        !findFunction(library, "WelsCreateSVCEncoder", found.createEncoder) ||
        !findFunction(library, "WelsDestroySVCEncoder", found.destroyEncoder) ||
        !findFunction(library, "WelsCreateDecoder", found.createDecoder) ||
        !findFunction(library, "WelsDestroyDecoder", found.destroyDecoder))
        return fail(ErrorCode::Unavailable, std::string("no H.264: ") + SCANCAST_OPENH264_SONAME +
                                                " lacks functions that every OpenH264 has" + wayOut);
    OpenH264Version is{};
    version(&is);
    found.version =
        std::to_string(is.uMajor) + "." + std::to_string(is.uMinor) + "." + std::to_string(is.uRevision);
    // Its structures grow with versions, while the soname stays.
    if (is.uMajor != OPENH264_MAJOR || is.uMinor < OPENH264_MINOR)
        return fail(ErrorCode::Unavailable,
                    "no H.264: " + std::string(SCANCAST_OPENH264_SONAME) + " is version " + found.version +
                        ", and this program was built for " + std::to_string(OPENH264_MAJOR) + "." +
                        std::to_string(OPENH264_MINOR));
    return found;
}

}  // namespace

Expected<const OpenH264*> openH264() {
    static const Expected<OpenH264> library = loadOpenH264();
    if (!library) return tl::unexpected(library.error());
    return &*library;
}

}  // namespace scancast
