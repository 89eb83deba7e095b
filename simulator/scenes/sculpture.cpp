#include "simulator/scenes/sculpture.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace scancast {
namespace {

using glm::vec2;
using glm::vec3;

// Bodies and how they are joined.

float ball(vec3 p, vec3 center, float radius) {
    return glm::distance(p, center) - radius;
}

float ellipsoid(vec3 p, vec3 center, vec3 radii) {
    const vec3 q = (p - center) / radii;
    const float k0 = glm::length(q), k1 = glm::length(q / radii);
    return k1 > 0 ? k0 * (k0 - 1) / k1 : -std::min({radii.x, radii.y, radii.z});
}

/// A limb from a to b, its radius going from r0 to r1.
float limb(vec3 p, vec3 a, vec3 b, float r0, float r1) {
    const vec3 ab = b - a, ap = p - a;
    const float along = std::clamp(glm::dot(ap, ab) / glm::dot(ab, ab), 0.0F, 1.0F);
    return glm::length(ap - ab * along) - (r0 + (r1 - r0) * along);
}

float box(vec3 p, vec3 half, float round) {
    const vec3 q = glm::abs(p) - half + round;
    return glm::length(glm::max(q, vec3(0))) + std::min(std::max({q.x, q.y, q.z}), 0.0F) - round;
}

float join(float a, float b, float soft) {
    const float h = std::max(soft - std::abs(a - b), 0.0F) / soft;
    return std::min(a, b) - h * h * soft * 0.25F;
}

float cut(float a, float b, float soft) {
    return -join(-a, b, soft);
}

float ease(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
    return t * t * (3 - 2 * t);
}

/// A smooth curve through heights and values.
template <std::size_t N>
float profile(const std::array<vec2, N>& knots, float z) {
    if (z <= knots.front().x) return knots.front().y;
    for (std::size_t i = 1; i < N; ++i)
        if (z < knots[i].x) {
            const float h = knots[i].x - knots[i - 1].x, t = (z - knots[i - 1].x) / h;
            const auto slope = [&](std::size_t k) {
                const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, N - 1);
                return (knots[b].y - knots[a].y) / (knots[b].x - knots[a].x) * h;
            };
            const float t2 = t * t, t3 = t2 * t;
            return knots[i - 1].y * (2 * t3 - 3 * t2 + 1) + slope(i - 1) * (t3 - 2 * t2 + t) +
                   knots[i].y * (3 * t2 - 2 * t3) + slope(i) * (t3 - t2);
        }
    return knots.back().y;
}

/// Folds of cloth: round tops and narrow valleys, -0.6 … 0.4.
float folds(float phase) {
    return std::sqrt(std::sin(phase) * std::sin(phase) + 0.01F) - 0.65F;
}

/// The robe from the shoulders to the ground, with the mantle laid around it.
float robe(vec3 p) {
    static const std::array<vec2, 12> width{{{0.0F, 0.292F},
                                             {0.06F, 0.272F},
                                             {0.3F, 0.238F},
                                             {0.6F, 0.216F},
                                             {0.88F, 0.208F},
                                             {1.0F, 0.196F},
                                             {1.13F, 0.150F},
                                             {1.22F, 0.156F},
                                             {1.36F, 0.180F},
                                             {1.45F, 0.178F},
                                             {1.51F, 0.110F},
                                             {1.56F, 0.030F}}};
    static const std::array<vec2, 6> depth{
        {{0.0F, 0.86F}, {0.5F, 0.80F}, {0.95F, 0.76F}, {1.13F, 0.74F}, {1.36F, 0.66F}, {1.57F, 0.80F}}};
    const float z = std::clamp(p.z, 0.0F, 1.6F), flat = profile(depth, z);
    // Weight on the right leg: the hips swing one way, the chest the other.
    const float sway = 0.022F * std::sin((z - 0.15F) * 3.0F), lean = 0.012F * std::sin(z * 4);
    const vec2 q(p.x - sway, (p.y - lean) / flat);
    const float radial = glm::length(q), turn = std::atan2(q.x, -q.y);  // 0 = front, positive = her left
    float radius = profile(width, z);

    const float skirt = 1 - ease(0.75F, 1.08F, z), hem = 1 - ease(0.0F, 0.7F, z),
                blouse = ease(1.14F, 1.2F, z);
    // Long folds fall from the hip; over the free leg, on her left, they part.
    const float knee = std::exp(-18 * (turn - 0.42F) * (turn - 0.42F)) * ease(0.12F, 0.4F, z);
    const float wander = 0.35F * std::sin(2.6F * z + turn) + 0.2F * std::sin(5.1F * z + 3 * turn);
    radius += skirt * (1 - 0.85F * knee) *
              ((0.018F + 0.026F * hem) * folds(7.5F * turn + wander) +
               (0.006F + 0.006F * hem) * folds(17 * turn + 2.2F * wander + 1));
    // Gathers above the belt, the cloth hanging over it a little.
    radius += blouse * (1 - ease(1.38F, 1.5F, z)) * 0.007F * folds(15 * turn + 2 * std::sin(7 * z));
    radius += 0.020F * std::exp(-std::pow((z - 1.185F) / 0.03F, 2.0F)) *
              (1 + 0.4F * std::sin(11 * turn + 1) + 0.25F * std::sin(23 * turn));
    // The belt.
    radius += 0.009F * (ease(1.098F, 1.106F, z) - ease(1.134F, 1.142F, z));

    // The mantle: from her left shoulder to the right hip, and down to above the knees.
    const float below =
        0.83F * q.x - 0.55F * (p.z - 1.24F) + (p.y > 0 ? 0.10F : 0.0F) * std::min(1.0F, p.y * 12);
    const float lower = 0.47F + 0.10F * std::sin(turn + 0.8F) + 0.018F * std::sin(6 * turn);
    const float covered =
        ease(-0.004F, 0.004F, below) * ease(lower - 0.006F, lower + 0.006F, p.z) * (1 - ease(1.5F, 1.54F, z));
    const float drawn = 46 * below * (0.75F + 0.15F * std::sin(2 * turn)) + 2 * turn + std::sin(3 * turn);
    radius += covered * (0.016F + 0.016F * folds(0.5F * drawn) * (0.5F + 0.5F * ease(0.0F, 0.1F, below)) -
                         0.5F * skirt * 0.018F * folds(7.5F * turn + wander));
    radius += 0.020F * std::exp(-std::pow((below - 0.02F) / 0.022F, 2.0F)) * ease(0.75F, 0.9F, p.z) *
              (1 - ease(1.44F, 1.52F, z)) * (1 + 0.25F * std::sin(below * 260 + 3 * turn));

    const float side = (radial - radius) * flat * 0.9F;
    return std::max(side, std::max(p.z - 1.555F, -p.z));
}

float hand(vec3 p, vec3 wrist, vec3 knuckles, vec3 spread, vec3 curl) {
    const vec3 palm = (wrist + knuckles) * 0.5F;
    float d = limb(p, wrist, knuckles, 0.024F, 0.028F);
    if (d > 0.15F) return d - 0.05F;
    d = join(d, ball(p, palm, 0.032F), 0.03F);
    for (int i = 0; i < 4; ++i) {
        const float off = (float(i) - 1.5F) * 0.0175F, reach = i == 0 || i == 3 ? 0.85F : 1.0F;
        const vec3 root = knuckles + spread * off, way = (knuckles - wrist) * 0.45F;
        const vec3 joint = root + way * reach + curl * 0.3F, tip = joint + way * (0.5F * reach) + curl;
        d = join(d, limb(p, root, joint, 0.0105F, 0.0092F), 0.008F);
        d = join(d, limb(p, joint, tip, 0.0092F, 0.0075F), 0.004F);
    }
    const vec3 thumb = palm - spread * 0.035F;
    return join(d, limb(p, thumb, thumb + (knuckles - wrist) * 0.5F + curl * 0.4F, 0.013F, 0.009F), 0.012F);
}

/// Both arms in wide sleeves; the right forearm holds a book before the chest, the left hand the mantle.
float arms(vec3 p) {
    const float outside = box(p - vec3(0.0F, -0.06F, 1.2F), {0.34F, 0.24F, 0.36F}, 0.01F);
    if (outside > 0.13F) return outside;
    const vec3 rightElbow(-0.262F, 0.005F, 1.13F), rightWrist(-0.075F, -0.195F, 1.185F);
    const vec3 leftElbow(0.268F, 0.045F, 1.15F), leftWrist(0.245F, -0.105F, 0.965F);
    const float crease = 0.006F * std::sin(p.z * 95 + 4 * std::sin(p.x * 20 + p.y * 13)) +
                         0.004F * std::sin(p.z * 51 - p.y * 60);
    float d = limb(p, {-0.168F, 0.005F, 1.455F}, rightElbow, 0.066F, 0.060F) + crease;
    d = join(d, limb(p, {0.168F, 0.005F, 1.455F}, leftElbow, 0.066F, 0.062F) + crease, 0.03F);
    // Sleeves end half way along the forearm, in a hanging edge.
    const vec3 rightCuff = rightElbow + (rightWrist - rightElbow) * 0.5F,
               leftCuff = leftElbow + (leftWrist - leftElbow) * 0.5F;
    d = join(d, limb(p, rightElbow, rightCuff, 0.060F, 0.058F) + crease, 0.03F);
    d = join(d, limb(p, leftElbow, leftCuff, 0.060F, 0.056F) + crease, 0.03F);
    d = join(
        d,
        limb(p, rightElbow + vec3(0.02F, -0.02F, -0.04F), rightCuff + vec3(0, 0, -0.11F), 0.045F, 0.018F) +
            crease,
        0.05F);
    d = join(d, limb(p, rightCuff, rightWrist, 0.038F, 0.027F), 0.006F);
    d = join(d, limb(p, leftCuff, leftWrist, 0.038F, 0.027F), 0.006F);
    d = join(d, hand(p, rightWrist, {-0.012F, -0.232F, 1.182F}, {0, 0.35F, 0.94F}, {0.012F, 0.022F, 0.0F}),
             0.012F);
    d = join(d, hand(p, leftWrist, {0.232F, -0.135F, 0.905F}, {0.5F, 0.8F, 0.2F}, {-0.018F, 0.012F, 0.004F}),
             0.012F);
    // The book: two covers and the leaves between them, tilted towards her.
    const vec3 c(0.035F, -0.205F, 1.225F);
    const float ca = 0.94F, sa = 0.34F;
    vec3 q = p - c;
    q = vec3(ca * q.x + sa * q.y, -sa * q.x + ca * q.y, q.z);
    q = vec3(q.x, 0.96F * q.y + 0.28F * q.z, -0.28F * q.y + 0.96F * q.z);
    const float book = box(q, {0.085F, 0.031F, 0.115F}, 0.006F);
    const float gap = box(q - vec3(0.03F, 0, 0), {0.085F, 0.019F, 0.14F}, 0.004F);
    const float leaves = box(q - vec3(-0.004F, 0, 0), {0.076F, 0.024F, 0.104F}, 0.003F);
    return std::min(d, std::min(cut(book, gap, 0.004F), leaves));
}

/// Waves of hair, combed back from a parting into a knot.
float hair(vec3 p) {
    const vec3 q = p - vec3(0, 0.018F, 1.768F);
    const float around = std::atan2(q.x, q.z + 0.02F),
                strands = 0.0035F * std::sin(60 * q.y + 3 * std::sin(14 * around)) +
                          0.0028F * folds(17 * around + 8 * q.y);
    float d = ellipsoid(p, {0, 0.018F, 1.768F}, {0.092F, 0.108F, 0.112F}) - strands;
    // The face stays free: what lies before a tilted plane is taken away, in an arch over the brow.
    const float face = -(q.y + 0.068F - 0.75F * std::abs(q.x) + 0.55F * std::max(0.0F, 0.045F - q.z));
    d = -join(-d, -(face - 0.012F), 0.012F);
    d = join(
        d,
        ellipsoid(p, {0, 0.128F, 1.775F}, {0.052F, 0.045F, 0.050F}) - 0.0035F * std::sin(90 * q.x + 70 * q.z),
        0.016F);
    // A plaited band around the head.
    const vec3 r(q.x, 0.93F * q.y - 0.36F * q.z, 0.36F * q.y + 0.93F * q.z);
    const float ring = glm::length(vec2(r.x * 1.07F, r.y * 0.94F)) - 0.0915F, high = r.z - 0.048F;
    const float plait = 0.0085F + 0.0018F * std::sin(44 * std::atan2(r.x, r.y));
    return join(d, glm::length(vec2(ring, high)) - plait, 0.004F);
}

float head(vec3 p) {
    // Turned a little to her left and bent towards the book.
    vec3 q = p - vec3(0.006F, 0, 1.572F);
    q = vec3(0.966F * q.x + 0.259F * q.y, -0.259F * q.x + 0.966F * q.y, q.z);
    q = vec3(q.x, 0.990F * q.y - 0.139F * q.z, 0.139F * q.y + 0.990F * q.z);
    q += vec3(0, 0.006F, 1.60F);
    const vec3 m(std::abs(q.x), q.y, q.z);  // both halves are alike
    float d = ellipsoid(q, {0, 0.004F, 1.762F}, {0.076F, 0.096F, 0.104F});
    d = join(d, ellipsoid(q, {0, -0.030F, 1.700F}, {0.058F, 0.066F, 0.072F}), 0.035F);
    d = join(d, ball(q, {0, -0.078F, 1.650F}, 0.0165F), 0.026F);     // chin
    d = join(d, ball(m, {0.036F, -0.064F, 1.708F}, 0.026F), 0.03F);  // cheeks
    d = join(d, limb(m, {0.010F, -0.0915F, 1.770F}, {0.050F, -0.071F, 1.774F}, 0.0070F, 0.006F),
             0.024F);                                                                            // brow
    d = cut(d, ellipsoid(m, {0.0315F, -0.1020F, 1.752F}, {0.0200F, 0.0145F, 0.0120F}), 0.014F);  // sockets
    d = join(d, ball(m, {0.0310F, -0.0775F, 1.7505F}, 0.0172F), 0.003F);                         // eyes
    d = join(d, limb(m, {0.0165F, -0.0915F, 1.7560F}, {0.0455F, -0.0835F, 1.7555F}, 0.0035F, 0.003F), 0.004F);
    d = join(d, limb(m, {0.0180F, -0.0915F, 1.7425F}, {0.0440F, -0.0845F, 1.7430F}, 0.0028F, 0.0025F),
             0.005F);
    d = join(d, limb(q, {0, -0.0930F, 1.770F}, {0, -0.1150F, 1.7175F}, 0.0062F, 0.0104F), 0.018F);  // nose
    d = join(d, ball(m, {0.0098F, -0.1035F, 1.7140F}, 0.0072F), 0.008F);
    d = join(d, limb(m, {0.004F, -0.0990F, 1.6870F}, {0.020F, -0.0890F, 1.6835F}, 0.0052F, 0.0028F),
             0.006F);  // lips
    d = join(d, limb(m, {0.000F, -0.0965F, 1.6760F}, {0.018F, -0.0885F, 1.6815F}, 0.0064F, 0.0026F), 0.004F);
    d = cut(d, limb(m, {0, -0.1045F, 1.6818F}, {0.022F, -0.0920F, 1.6828F}, 0.0008F, 0.0004F), 0.005F);
    d = join(d, ellipsoid(m, {0.077F, 0.008F, 1.735F}, {0.010F, 0.020F, 0.030F}), 0.008F);  // ears
    d = join(d, hair(q), 0.005F);
    return d;
}

}  // namespace

float sculptureDistance(const vec3& at) {
    const vec3 p = at;
    float d = robe(p);
    d = join(d, limb(p, {-0.165F, 0.008F, 1.452F}, {0.165F, 0.008F, 1.452F}, 0.066F, 0.066F), 0.06F);
    for (const float side : {-1.0F, 1.0F})
        d = join(d, ball(p, {0.078F * side, -0.088F, 1.318F}, 0.062F), 0.05F);
    d = join(d, limb(p, {0.105F, -0.125F, 0.60F}, {0.085F, -0.075F, 0.95F}, 0.062F, 0.095F),
             0.10F);  // free knee
    d = join(d, limb(p, {0.105F, -0.125F, 0.60F}, {0.120F, -0.130F, 0.15F}, 0.050F, 0.040F), 0.09F);
    for (const float side : {-1.0F, 1.0F}) {
        const vec3 heel(0.09F * side, -0.16F, 0.03F),
            toe(0.115F * side, side > 0 ? -0.305F : -0.285F, 0.022F);
        d = join(d, limb(p, heel, toe, 0.042F, 0.028F), 0.012F);
    }
    d = join(d, arms(p), 0.010F);
    const float nearHead = ball(p, {0, 0, 1.73F}, 0.22F);
    if (nearHead > 0.13F) return std::min(d, nearHead);
    float top = limb(p, {0.0F, 0.012F, 1.48F}, {0.0F, 0.004F, 1.66F}, 0.060F, 0.052F);
    top = join(top, head(p), 0.018F);
    return join(d, top, 0.022F);
}

namespace {

constexpr float trust = 0.5F;

/// What nearby stone leaves of the sky around a normal.
float opennessAt(const vec3& at, const vec3& normal) {
    float open = 1;
    for (const auto& [height, weight] : {std::pair(0.012F, 0.30F), {0.04F, 0.32F}, {0.12F, 0.34F}})
        open *= 1 - weight * std::clamp(1 - sculptureDistance(at + normal * height) / height, 0.0F, 1.0F);
    return open;
}

/// 0 where the way to the sun is blocked, 1 where it is free, between them the penumbra of its disc.
float sunlitAt(const vec3& at, const vec3& normal) {
    if (glm::dot(normal, statueSun) <= 0) return 0;
    float light = 1;
    const vec3 from = at + normal * 0.004F;
    for (float way = 0.006F; way < 1.2F;) {
        const float gap = sculptureDistance(from + statueSun * way);
        light = std::min(light, 24 * gap / way);
        if (light <= 0) return 0;
        way += std::clamp(gap * 0.7F, 0.006F, 0.15F);
    }
    return light;
}

Sculpture carve() {
    // The head gets a finer net; the two overlap where the neck is smooth.
    SurfaceMesh mesh =
        surfaceNet(sculptureDistance, {-0.40F, -0.40F, -0.016F}, {0.40F, 0.36F, 1.595F}, 0.008F, trust);
    const SurfaceMesh fine =
        surfaceNet(sculptureDistance, {-0.16F, -0.18F, 1.580F}, {0.16F, 0.24F, 1.93F}, 0.004F, trust);
    const auto shift = std::uint32_t(mesh.position.size());
    mesh.position.insert(mesh.position.end(), fine.position.begin(), fine.position.end());
    mesh.normal.insert(mesh.normal.end(), fine.normal.begin(), fine.normal.end());
    for (std::array<std::uint32_t, 3> corners : fine.triangles) {
        for (std::uint32_t& corner : corners) corner += shift;
        mesh.triangles.push_back(corners);
    }
    Sculpture result{std::move(mesh), {}, {}};
    const std::size_t vertices = result.mesh.position.size();
    result.openness.resize(vertices);
    result.sunlit.resize(vertices);
    tbb::parallel_for(std::size_t(0), vertices, [&](std::size_t i) {
        result.openness[i] = opennessAt(result.mesh.position[i], result.mesh.normal[i]);
        result.sunlit[i] = sunlitAt(result.mesh.position[i], result.mesh.normal[i]);
    });
    return result;
}

}  // namespace

const Sculpture& sculpture() {
    // Isolated, so that a thread that waits for its helpers takes no other task that would come back here.
    static const Sculpture carved = tbb::this_task_arena::isolate(carve);
    return carved;
}

}  // namespace scancast
