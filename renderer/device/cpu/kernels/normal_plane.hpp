// The plane of normals between passes: one word a pixel, octahedral 16 + 16 bits in view space (x right, y
// up, z towards the viewer), 0 where there is none. Error below 0.005°, so what a picture shows is the
// samples' own 8 + 8 bits, not this. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/vectors.hpp"

namespace scancast::cpu {
namespace {

inline FloatW absolute(FloatW v) {
    return v < 0.0f ? -v : v;
}

inline FloatW withSign(FloatW magnitude, FloatW sign) {
    return sign < 0.0f ? -magnitude : magnitude;
}

/// Of any length; 0 where that is 0 or not a number.
inline IntW packNormal(FloatW x, FloatW y, FloatW z) {
    const FloatW sum = absolute(x) + absolute(y) + absolute(z);
    const IntW known = (sum > 0.0f) & (sum < 3.4e38f);
    const FloatW inverse = 1.0f / (known ? sum : all(1.0f));
    const FloatW px = x * inverse, py = y * inverse;
    const FloatW u = z < 0.0f ? withSign(1.0f - absolute(py), px) : px;
    const FloatW v = z < 0.0f ? withSign(1.0f - absolute(px), py) : py;
    // 1 … 65535, so that no normal is 0; the middle, 32768, is exact.
    const IntW iu = toInt(floorOf((known ? u : all(0.0f)) * 32767.0f + 32768.5f));
    const IntW iv = toInt(floorOf((known ? v : all(0.0f)) * 32767.0f + 32768.5f));
    return known ? (iu << 16) | iv : all(0);
}

/// Unit vectors; (0, 0, 0) where there is none.
inline void unpackNormal(IntW code, FloatW& x, FloatW& y, FloatW& z) {
    const FloatW u = (toFloat((code >> 16) & 0xffff) - 32768.0f) / 32767.0f;
    const FloatW v = (toFloat(code & 0xffff) - 32768.0f) / 32767.0f;
    z = 1.0f - absolute(u) - absolute(v);
    x = z < 0.0f ? withSign(1.0f - absolute(v), u) : u;
    y = z < 0.0f ? withSign(1.0f - absolute(u), v) : v;
    const FloatW inverse = 1.0f / squareRoot<wideLanes>(x * x + y * y + z * z);
    const FloatW scale = code == 0 ? all(0.0f) : inverse;
    x = x * scale;
    y = y * scale;
    z = z * scale;
}

/// A sample's 8 + 8 bits (renderer/cloud/sample.hpp), cloud space, before it is made one unit long: the
/// direction is exact. (0, 0, 0) where there is none.
inline void unpackSampleNormal(IntW code, FloatW& x, FloatW& y, FloatW& z) {
    const FloatW u = toFloat(((code >> 8) & 255) - 128), v = toFloat((code & 255) - 128);
    z = 127.0f - absolute(u) - absolute(v);
    x = z < 0.0f ? withSign(127.0f - absolute(v), u) : u;
    y = z < 0.0f ? withSign(127.0f - absolute(u), v) : v;
    const IntW none = (code & 0xffff) == 0;
    x = none ? all(0.0f) : x;
    y = none ? all(0.0f) : y;
    z = none ? all(0.0f) : z;
}

}  // namespace
}  // namespace scancast::cpu
