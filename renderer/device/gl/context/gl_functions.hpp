// The OpenGL functions that this room calls, and no others: loaded from one context's own GetProcAddress, so
// that OSMesa and a vendor's libGL can live in one process. Owned by a context, used on its thread while it
// is current.
#pragma once

#include <GL/glcorearb.h>

#include "protocol/error.hpp"

namespace scancast::gl {

// X(PFN type's middle, name without "gl")
#define SCANCAST_GL_FUNCTIONS(X)                        \
    X(ATTACHSHADER, AttachShader)                       \
    X(BINDBUFFERBASE, BindBufferBase)                   \
    X(BINDTEXTUREUNIT, BindTextureUnit)                 \
    X(CLEARNAMEDBUFFERSUBDATA, ClearNamedBufferSubData) \
    X(CLIENTWAITSYNC, ClientWaitSync)                   \
    X(COMPILESHADER, CompileShader)                     \
    X(COPYNAMEDBUFFERSUBDATA, CopyNamedBufferSubData)   \
    X(CREATEBUFFERS, CreateBuffers)                     \
    X(CREATEPROGRAM, CreateProgram)                     \
    X(CREATEQUERIES, CreateQueries)                     \
    X(CREATESHADER, CreateShader)                       \
    X(CREATETEXTURES, CreateTextures)                   \
    X(DEBUGMESSAGECALLBACK, DebugMessageCallback)       \
    X(DEBUGMESSAGECONTROL, DebugMessageControl)         \
    X(DELETEBUFFERS, DeleteBuffers)                     \
    X(DELETEPROGRAM, DeleteProgram)                     \
    X(DELETEQUERIES, DeleteQueries)                     \
    X(DELETESHADER, DeleteShader)                       \
    X(DELETESYNC, DeleteSync)                           \
    X(DELETETEXTURES, DeleteTextures)                   \
    X(DISPATCHCOMPUTE, DispatchCompute)                 \
    X(ENABLE, Enable)                                   \
    X(FENCESYNC, FenceSync)                             \
    X(GETERROR, GetError)                               \
    X(GETGRAPHICSRESETSTATUS, GetGraphicsResetStatus)   \
    X(GETINTEGER64V, GetInteger64v)                     \
    X(GETINTEGERV, GetIntegerv)                         \
    X(GETNAMEDBUFFERSUBDATA, GetNamedBufferSubData)     \
    X(GETPROGRAMBINARY, GetProgramBinary)               \
    X(GETPROGRAMINFOLOG, GetProgramInfoLog)             \
    X(GETPROGRAMIV, GetProgramiv)                       \
    X(GETQUERYIV, GetQueryiv)                           \
    X(GETQUERYOBJECTUI64V, GetQueryObjectui64v)         \
    X(GETSHADERINFOLOG, GetShaderInfoLog)               \
    X(GETSHADERIV, GetShaderiv)                         \
    X(GETSTRING, GetString)                             \
    X(GETSTRINGI, GetStringi)                           \
    X(LINKPROGRAM, LinkProgram)                         \
    X(MAPNAMEDBUFFERRANGE, MapNamedBufferRange)         \
    X(MEMORYBARRIER, MemoryBarrier)                     \
    X(NAMEDBUFFERSTORAGE, NamedBufferStorage)           \
    X(NAMEDBUFFERSUBDATA, NamedBufferSubData)           \
    X(OBJECTLABEL, ObjectLabel)                         \
    X(PROGRAMBINARY, ProgramBinary)                     \
    X(PROGRAMPARAMETERI, ProgramParameteri)             \
    X(QUERYCOUNTER, QueryCounter)                       \
    X(SHADERSOURCE, ShaderSource)                       \
    X(TEXTUREBUFFER, TextureBuffer)                     \
    X(UNIFORM1UI, Uniform1ui)                           \
    X(USEPROGRAM, UseProgram)

struct GlFunctions {
#define SCANCAST_GL_MEMBER(type, name) PFNGL##type##PROC name = nullptr;
    SCANCAST_GL_FUNCTIONS(SCANCAST_GL_MEMBER)
#undef SCANCAST_GL_MEMBER
};

using GlProc = void (*)();
using GetProcAddress = GlProc (*)(const char*);

/// DeviceUnavailable names the first function that the driver lacks.
Expected<GlFunctions> loadFunctions(GetProcAddress getProcAddress);

/// "GL_OUT_OF_MEMORY" …
const char* glErrorName(GLenum error);

}  // namespace scancast::gl
