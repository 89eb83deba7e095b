// Borders between neighbouring paraboloids' cells, smoothed (docs/spec/sprites.md section 9), as the cpu device does it
// (kernels/smooth.hpp).
#version 450 core
#include "layouts_splat.glsl"
#include "exact.glsl"
#include "formulas.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 0) uniform Params { SmoothParams pass; };
layout(std430, binding = 0) readonly buffer Places { uint places[]; };  // owners.glsl
layout(std430, binding = 1) readonly buffer Halves { float halves[]; };
layout(std430, binding = 2) readonly buffer Depth { float depth[]; };
layout(std430, binding = 3) readonly buffer Rgba { uint rgba[]; };
layout(std430, binding = 4) writeonly buffer Smoothed { uint smoothed[]; };

const float background = 3.4e38, far = 1e30;

// The paraboloid that a pixel shows. From its centre to a pixel: x, y.
struct Paraboloid {
    float x, y, halfPx, depth, rise;
};

float squared(float x, float y) {
    precise float sum = x * x + y * y;
    return sum;
}

float orderOf(Paraboloid p) {
    precise float order = p.depth + p.rise * squared(p.x, p.y);
    return order;
}

// Px beyond what the splat covers; negative inside.
float beyond(Paraboloid p) {
    float away = pass.size.w != 0 ? max(abs(p.x), abs(p.y)) : root(squared(p.x, p.y));
    precise float out_ = away - p.halfPx;
    return out_;
}

// Of a pixel whose order is known, seen from the one that lies `dx` to its left and `dy` above.
Paraboloid shownAt(int pixel, float order, float dx, float dy) {
    uint place = places[pixel];
    Paraboloid p;
    precise float x = (float(place & 0xffffu) - placeMiddle) * placeStep;
    precise float y = (float(place >> 16) - placeMiddle) * placeStep;
    p.halfPx = halves[pixel];
    // The centre's own pixel has the centre's depth.
    bool centre = x > -0.5 && x <= 0.5 && y > -0.5 && y <= 0.5;
    float perPx2 = quotient(pass.bulge.x, p.halfPx), distance2 = squared(x, y);
    precise float bulge = perPx2 * distance2;
    precise float share = 1.0 + bulge;
    precise float less = order - bulge;
    if (pass.size.z != 0) {
        p.depth = centre ? order : quotient(order, share);
        precise float rise = perPx2 * p.depth;
        p.rise = rise;
    } else {
        p.depth = centre ? order : less;
        p.rise = perPx2;
    }
    precise float fromX = x - dx;
    precise float fromY = y - dy;
    p.x = fromX;
    p.y = fromY;
    return p;
}

// The same cell; or two without a border between them.
bool sameCell(Paraboloid a, Paraboloid b) {
    precise float apartX = a.x - b.x;
    precise float apartY = a.y - b.y;
    return a.halfPx == b.halfPx && abs(apartX) <= placeStep && abs(apartY) <= placeStep;
}

// How far a pixel's centre, which shows `own`, lies from where `other` begins, which its neighbour `dx` to the right and `dy`
// below shows; px. Both are seen from the pixel.
float distanceToBorder(Paraboloid own, Paraboloid other, float dx, float dy) {
    precise float rises = own.rise + other.rise;
    float unit = quotient(1.0, max(rises, leastRise));
    precise float a = own.rise * unit;
    precise float b = other.rise * unit;
    precise float gx = b * other.x - a * own.x;
    precise float gy = b * other.y - a * own.y;
    precise float slope = 2.0 * root(squared(gx, gy));
    precise float apart = (orderOf(other) - orderOf(own)) * unit;
    float between = quotient(apart, max(slope, leastSlope));
    // What is behind begins where the nearer one ends, if that is on the neighbour's side.
    precise float along = dx * own.x + dy * own.y;
    precise float along2 = 2.0 * (along * along);
    bool side = along > 0.0 && along2 >= squared(own.x, own.y);
    float end = side ? -beyond(own) : far;
    return max(beyond(other), min(between, end));
}

uint blended(uint own, uint other, float share) {
    uint mean = own & 0xff000000u;
    for (int shift = 0; shift < 24; shift += 8) {
        float a = float((own >> shift) & 255u), b = float((other >> shift) & 255u);
        precise float channel = (a + (b - a) * share) + 0.5;
        mean |= uint(channel) << shift;
    }
    return mean;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, pass.size.xy))) return;
    int pixel = at.y * pass.size.x + at.x;
    uint color = rgba[pixel];
    float order = depth[pixel];
    if (order > background) {
        smoothed[pixel] = color;
        return;
    }
    Paraboloid own = shownAt(pixel, order, 0.0, 0.0);
    uint neighbour = color;
    float nearest = 0.5;
    for (int k = 0; k < 4; ++k) {
        ivec2 to = k < 2 ? ivec2(1 - 2 * k, 0) : ivec2(0, 5 - 2 * k);
        ivec2 place = at + to;
        if (any(lessThan(place, ivec2(0))) || any(greaterThanEqual(place, pass.size.xy))) continue;
        int there = place.y * pass.size.x + place.x;
        float othersOrder = depth[there];
        if (othersOrder > background) continue;
        Paraboloid other = shownAt(there, othersOrder, float(to.x), float(to.y));
        if (sameCell(own, other)) continue;
        float distance = distanceToBorder(own, other, float(to.x), float(to.y));
        if (!(distance < nearest)) continue;
        nearest = max(distance, 0.0);
        neighbour = rgba[there];
    }
    precise float share = 0.5 - nearest;
    smoothed[pixel] = blended(color, neighbour, share);
}
