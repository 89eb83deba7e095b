// eye-dome lighting from depth alone (methods.md section 9), with the cpu device's own log2 and exp2, operation by
// operation: a driver's differ from one to the next.
#version 450 core
#include "layouts.glsl"

layout(local_size_x = 16, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { EyeDomeParams pass; };
layout(std430, binding = 4) readonly buffer Depths { float depths[]; };
layout(std430, binding = 7) readonly buffer Resolved { uint resolved[]; };
layout(std430, binding = 8) writeonly buffer Shaded { uint shaded[]; };

const float background = 3.4e38;

float log2Of(float value) {
    int bits = floatBitsToInt(value);
    int exponent = (bits - 0x3f3504f3) >> 23;
    float m = intBitsToFloat(bits - exponent * (1 << 23));
    precise float s = (m - 1.0) / (m + 1.0);
    precise float s2 = s * s;
    precise float series = 0.41219858 + s2 * 0.32059890;
    precise float log2m = s * (2.88539008 + s2 * (0.96179669 + s2 * (0.57707802 + s2 * series)));
    precise float sum = float(exponent) + log2m;
    return sum;
}

float exp2Of(float x) {
    float bounded = max(x, -120.0);
    precise float whole = floor(bounded + 0.5);
    precise float f = bounded - whole;
    precise float tail = 0.0013333558 + f * 0.00015403530;
    precise float p = 1.0 + f * (0.69314718 + f * (0.24022651 + f * (0.055504109 + f * (0.0096181291 + f * tail))));
    precise float scaled = p * intBitsToFloat((int(whole) + 127) * (1 << 23));
    return x < -120.0 ? 0.0 : scaled;
}

// How much nearer a neighbour lies, in octaves; beyond the area lies background, which adds nothing.
float response(float own, ivec2 at) {
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, pass.area.zw))) return 0.0;
    float depth = depths[at.y * pass.area.z + at.x];
    if (depth > background) return 0.0;
    precise float rise = own - log2Of(depth);
    return max(rise, 0.0);
}

void main() {
    ivec2 out2 = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(out2, pass.window.zw))) return;
    ivec2 at = out2 + pass.window.xy - pass.area.xy;
    int pixel = at.y * pass.area.z + at.x;
    uint rgba = resolved[pixel];
    float depth = depths[pixel];
    uint result = rgba;
    if (depth <= background) {
        float own = log2Of(depth);
        precise float sum = 0.0;
        for (int k = 0; k < 4; ++k) {
            sum += response(own, at + pass.offsets[k].xy);
            sum += response(own, at + pass.offsets[k].zw);
        }
        precise float exponent = -(pass.strength.x * sum);
        float shade = exp2Of(exponent);
        result = rgba & 0xff000000u;
        for (int c = 0; c < 24; c += 8) {
            precise float channel = float((rgba >> c) & 255u) * shade + 0.5;
            result |= uint(channel) << c;
        }
    }
    shaded[out2.y * pass.window.z + out2.x] = result;
}
