#include "renderer/device/gl/passes/glass.hpp"

#include "renderer/device/gl/programs/screen_layouts.hpp"

namespace scancast::gl {
namespace {

vec4 linear(const float (&values)[3], float last) {
    return {values[0], values[1], values[2], last};
}

Expected<void> layOver(const GlassNumbers& glass, const glm::ivec4& area, const GpuPlanes& picture,
                       bool through, bool normals, ScreenShaders& shaders) {
    GlassParams params{};
    params.picture = picture.area;
    params.reflected = area;
    params.depthAt = linear(glass.depthAt, glass.margin);
    params.rightAt = linear(glass.rightAt, glass.perspective ? 1 : 0);
    params.upAt = linear(glass.upAt, 0);
    params.tint = ivec4(glass.tint[0], glass.tint[1], glass.tint[2], normals ? 1 : 0);
    if (auto ok = shaders.set(params); !ok) return ok;
    picture.rgba->bindStorage(BindPlaneRgba);
    picture.depth->bindStorage(BindPlaneDepth);
    const Define defines[] = {{"THROUGH", through ? 1 : 0}};
    return shaders.overPixels("glass.comp", area.z, area.w, defines);
}

}  // namespace

Expected<void> lookThrough(const GlassNumbers& glass, const GpuPlanes& reflected, const GpuPlanes& picture,
                           ScreenShaders& shaders) {
    const bool normals = picture.normals != nullptr && reflected.normals != nullptr;
    reflected.rgba->bindStorage(BindReflectedRgba);
    reflected.depth->bindStorage(BindReflectedDepth);
    // Without normals the shader does not look at what stands there.
    (normals ? picture.normals : picture.rgba)->bindStorage(BindPlaneNormals);
    (normals ? reflected.normals : reflected.rgba)->bindStorage(BindReflectedNormals);
    return layOver(glass, reflected.area, picture, true, normals, shaders);
}

Expected<void> tintGlass(const GlassNumbers& glass, const glm::ivec4& area, const GpuPlanes& picture,
                         ScreenShaders& shaders) {
    return layOver(glass, area, picture, false, false, shaders);
}

}  // namespace scancast::gl
