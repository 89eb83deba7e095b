// Pixels of an area that splat passes drew, and their places in planes that hold it. One thread a pixel.
layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { ResolveParams pass; };

// False: this thread has none. `pixel` counts in the area, `place` in the planes.
bool pixelHere(out ivec2 at, out uint pixel, out uint place) {
    at = ivec2(gl_GlobalInvocationID.xy);
    pixel = uint(at.y * pass.area.z + at.x);
    ivec2 there = at + pass.area.xy - pass.planes.xy;
    place = uint(there.y * pass.planes.z + there.x);
    return all(lessThan(at, pass.area.zw));
}
