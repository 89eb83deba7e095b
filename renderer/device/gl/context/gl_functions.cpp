#include "renderer/device/gl/context/gl_functions.hpp"

namespace scancast::gl {

Expected<GlFunctions> loadFunctions(GetProcAddress getProcAddress) {
    GlFunctions functions;
#define SCANCAST_GL_LOAD(type, name)                                                           \
    functions.name = reinterpret_cast<PFNGL##type##PROC>(getProcAddress("gl" #name));          \
    if (!functions.name)                                                                       \
        return fail(ErrorCode::DeviceUnavailable, "The OpenGL driver has no function gl" #name \
                                                  "; OpenGL 4.5 is needed: update the driver " \
                                                  "(Debian: apt install libgl1-mesa-dri).");
    SCANCAST_GL_FUNCTIONS(SCANCAST_GL_LOAD)
#undef SCANCAST_GL_LOAD
    return functions;
}

const char* glErrorName(GLenum error) {
    switch (error) {
        case GL_NO_ERROR:
            return "GL_NO_ERROR";
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        case GL_CONTEXT_LOST:
            return "GL_CONTEXT_LOST";
        default:
            return "an unknown OpenGL error";
    }
}

}  // namespace scancast::gl
