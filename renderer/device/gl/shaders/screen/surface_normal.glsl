// Normals from the depths of one level: central differences; towards a side without depth, outside, or across an
// outline, one-sided ones. docs/spec/pyramid.md section 6; as the cpu device computes it (kernels/depth_normals.hpp).
// After exact.glsl and pyramid.glsl; whoever includes this defines depthAt(), of a texel inside the level.

float depthAt(int level, ivec2 at);

// A texel's point in view space, z towards the viewer.
vec3 viewPointOf(float texel, vec2 at, float depth) {
    float scale = perspective() ? depth : 1.0;
    precise float x = ((at.x + 0.5) * texel - pyramid.layerView.x) * pyramid.layerView.z * scale;
    precise float y = (pyramid.layerView.y - (at.y + 0.5) * texel) * pyramid.layerView.z * scale;
    return vec3(x, y, -depth);
}

// Where one side's depth is this many texels further off than steepness times the other's, an outline lies between.
const float outlineTexels = 2.0, outlineSteepness = 4.0;

float riseOf(float depth, float side) {
    precise float rise = abs(side - depth);
    return rise < 1e30 ? rise : 1e30;
}

float shareOf(float own, float other, float least, float depth) {
    precise float size = least + outlineSteepness * other;
    precise float s = 2.0 - quotient(own, size);
    s = s > 0.0 ? s : 0.0;
    s = s < 1.0 ? s : 1.0;
    return depth < finiteDepths ? s : 0.0;
}

// How much of the way to two neighbours is the slope that `depth` is on: 1, less where an outline begins, 0 beyond it.
vec2 sameSurface(float depth, float texel, float first, float second) {
    float a = riseOf(depth, first), b = riseOf(depth, second);
    precise float least = outlineTexels * texel;
    return vec2(shareOf(a, b, least, first), shareOf(b, a, least, second));
}

vec3 beside(float texel, vec3 own, float ownDepth, vec2 at, float depth, float share) {
    vec3 p = viewPointOf(texel, at, depth < finiteDepths ? depth : ownDepth);
    precise vec3 place = own + (p - own) * share;
    return place;
}

vec3 normalAt(int level, ivec2 at) {
    ivec2 last = sizeOf(level) - 1, before = max(at - 1, ivec2(0)), behind = min(at + 1, last);
    float depth = depthAt(level, at);
    // Beyond the border nothing is known.
    float left = at.x > 0 ? depthAt(level, ivec2(before.x, at.y)) : infinity;
    float right = at.x < last.x ? depthAt(level, ivec2(behind.x, at.y)) : infinity;
    float upper = at.y > 0 ? depthAt(level, ivec2(at.x, before.y)) : infinity;
    float lower = at.y < last.y ? depthAt(level, ivec2(at.x, behind.y)) : infinity;
    float texel = float(1 << level);
    precise float texelSize = (texel * pyramid.layerView.z) * (perspective() ? depth : 1.0);
    vec3 own = viewPointOf(texel, vec2(at), depth);
    vec2 across = sameSurface(depth, texelSize, right, left), along = sameSurface(depth, texelSize, upper, lower);
    precise vec3 a = beside(texel, own, depth, vec2(behind.x, at.y), right, across.x) -
                     beside(texel, own, depth, vec2(before.x, at.y), left, across.y);
    precise vec3 b = beside(texel, own, depth, vec2(at.x, before.y), upper, along.x) -
                     beside(texel, own, depth, vec2(at.x, behind.y), lower, along.y);
    precise float nx = a.y * b.z - a.z * b.y;
    precise float ny = a.z * b.x - a.x * b.z;
    precise float nz = a.x * b.y - a.y * b.x;
    precise float square = nx * nx + ny * ny + nz * nz;
    // Nothing to compare with: facing the viewer.
    if (!(square > 1e-37 && square < finiteDepths)) return vec3(0.0, 0.0, 1.0);
    float scale = quotient(1.0, root(square));
    precise vec3 unit = vec3(nx, ny, nz) * scale;
    return unit;
}
