#include "tests/ground_truth/patch_ray.hpp"

#include <algorithm>
#include <cmath>

#include "tests/ground_truth/polynomial.hpp"

namespace scancast {
namespace {

/// Neighbouring patches overlap by this part of their size, so that no ray slips through between them.
constexpr double seam = 1e-9;

double turnOf(double y, double x) {
    const double turn = std::atan2(y, x) / tau;
    return turn < 0 ? turn + 1 : turn;
}

std::optional<PatchHit> meetTrapezoid(const Patch& patch, const Ray& ray, double low, double high,
                                      double offset) {
    const double slope = glm::dot(patch.normal, ray.direction);
    if (slope == 0) return std::nullopt;
    const glm::dvec3 corner = patch.origin + patch.normal * offset;
    const double t = glm::dot(patch.normal, corner - ray.origin) / slope;
    if (!(t > low && t < high)) return std::nullopt;
    const glm::dvec3 at = ray.at(t) - corner;
    const double uu = glm::dot(patch.u, patch.u), uv = glm::dot(patch.u, patch.v),
                 vv = glm::dot(patch.v, patch.v), au = glm::dot(at, patch.u), av = glm::dot(at, patch.v);
    const double determinant = uu * vv - uv * uv;
    const double across = (au * vv - av * uv) / determinant, height = (av * uu - au * uv) / determinant;
    const double shrink = 1 - patch.taper, width = 1 - shrink * height;
    if (!(height >= -seam && height <= 1 + seam && across >= -seam && across <= width + seam))
        return std::nullopt;
    PatchHit hit;
    hit.t = t;
    hit.a = width > 0 ? std::clamp(across / width, 0.0, 1.0) : 0;
    hit.b = std::clamp(height * (2 - shrink * height) / (2 - shrink), 0.0, 1.0);
    hit.point.s = patch.lengthU * across;
    hit.point.t = patch.lengthV * height;
    hit.point.position = ray.at(t);
    hit.point.normal = patch.normal;
    return hit;
}

/// The roots of a·t² + 2·b·t + c, in order; false when there are none.
bool rootsOf(double a, double b, double c, std::array<double, 2>& roots) {
    const double inside = b * b - a * c;
    if (!(inside >= 0) || (a == 0 && b == 0)) return false;
    // The form that never subtracts nearly equal numbers.
    const double q = -(b + std::copysign(std::sqrt(inside), b));
    roots = a == 0 ? std::array{c / q, c / q} : q == 0 ? std::array{0.0, 0.0} : std::array{q / a, c / q};
    if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
    return true;
}

std::optional<PatchHit> meetTube(const Patch& patch, const Ray& ray, double low, double high, double offset) {
    const glm::dvec3 from = ray.origin - patch.origin;
    const double axis2 = glm::dot(patch.v, patch.v);
    const double height0 = glm::dot(from, patch.v) / axis2,
                 heightT = glm::dot(ray.direction, patch.v) / axis2;
    const glm::dvec3 side0 = from - patch.v * height0, sideT = ray.direction - patch.v * heightT;
    const double widening = patch.radius1 - patch.radius0;
    const double radius0 = patch.radius0 + offset + widening * height0, radiusT = widening * heightT;
    std::array<double, 2> roots;
    if (!rootsOf(glm::dot(sideT, sideT) - radiusT * radiusT, glm::dot(side0, sideT) - radius0 * radiusT,
                 glm::dot(side0, side0) - radius0 * radius0, roots))
        return std::nullopt;
    for (const double t : roots) {
        const double height = height0 + heightT * t;
        if (!(t > low && t < high && height >= -seam && height <= 1 + seam) || radius0 + radiusT * t < 0)
            continue;
        PatchHit hit;
        hit.t = t;
        const glm::dvec3 out = glm::normalize(side0 + sideT * t);
        const double shrink = 1 - patch.taper;
        hit.a = turnOf(glm::dot(out, patch.u), glm::dot(out, patch.normal));
        hit.b = std::clamp(height * (2 - shrink * height) / (2 - shrink), 0.0, 1.0);
        hit.point.s = patch.lengthU * hit.a;
        hit.point.t = patch.lengthV * height;
        hit.point.position = ray.at(t);
        hit.point.normal = out;
        return hit;
    }
    return std::nullopt;
}

std::optional<PatchHit> meetBall(const Patch& patch, const Ray& ray, double low, double high, double offset) {
    const glm::dvec3 from = ray.origin - patch.origin;
    const double radius = patch.radius0 + offset;
    std::array<double, 2> roots;
    if (!rootsOf(glm::dot(ray.direction, ray.direction), glm::dot(from, ray.direction),
                 glm::dot(from, from) - radius * radius, roots))
        return std::nullopt;
    for (const double t : roots) {
        if (!(t > low && t < high)) continue;
        PatchHit hit;
        hit.t = t;
        const glm::dvec3 out = (from + ray.direction * t) / radius;
        hit.a = turnOf(out.y, out.x);
        hit.b = std::clamp((out.z + 1) / 2, 0.0, 1.0);
        hit.point.s = patch.lengthU * hit.a;
        hit.point.t = patch.lengthV * hit.b;
        hit.point.position = ray.at(t);
        hit.point.normal = out;
        return hit;
    }
    return std::nullopt;
}

std::optional<PatchHit> meetDisc(const Patch& patch, const Ray& ray, double low, double high, double offset) {
    if (ray.direction.z == 0) return std::nullopt;
    const double t = (patch.origin.z + offset - ray.origin.z) / ray.direction.z;
    if (!(t > low && t < high)) return std::nullopt;
    const glm::dvec3 at = ray.at(t) - patch.origin;
    const double r = std::hypot(at.x, at.y), r0 = patch.radius0, r1 = patch.radius1;
    if (r < r0 - seam * r1 || r > r1 + seam * r1) return std::nullopt;
    PatchHit hit;
    hit.t = t;
    hit.a = turnOf(at.y, at.x);
    hit.b = std::clamp((r * r - r0 * r0) / (r1 * r1 - r0 * r0), 0.0, 1.0);
    hit.point.s = patch.lengthU * hit.a;
    hit.point.t = r;
    hit.point.position = ray.at(t);
    hit.point.normal = {0, 0, 1};
    return hit;
}

/// |p|² + R² - r² squared = 4 R² × the squared distance from the axis: a quartic in t.
std::optional<PatchHit> meetTorus(const Patch& patch, const Ray& ray, double low, double high,
                                  double offset) {
    const double ring = patch.radius0, tube = patch.radius1 + offset, outer = ring + tube;
    // Counted in metres from where the ray is nearest to the centre: small numbers keep the quartic exact.
    const double length = glm::length(ray.direction);
    const glm::dvec3 way = ray.direction / length;
    const double nearest = glm::dot(patch.origin - ray.origin, way);
    const glm::dvec3 from = ray.origin + way * nearest - patch.origin;
    const double gap2 = glm::dot(from, from);
    if (gap2 > outer * outer) return std::nullopt;
    const double half = std::sqrt(outer * outer - gap2) * (1 + 1e-9);
    const double first = std::max(-half, low * length - nearest),
                 last = std::min(half, high * length - nearest);
    if (!(first < last)) return std::nullopt;
    const double height0 = glm::dot(from, patch.v), heightT = glm::dot(way, patch.v);
    const double k = gap2 + ring * ring - tube * tube, four = 4 * ring * ring;
    // With `from` perpendicular to `way`: (t² + k)² - 4R² (t² + gap² - (height0 + heightT t)²).
    const std::array<double, 5> quartic{k * k - four * (gap2 - height0 * height0),
                                        2 * four * height0 * heightT, 2 * k - four * (1 - heightT * heightT),
                                        0, 1};
    const std::optional<double> root = firstRoot(quartic, first, last);
    if (!root) return std::nullopt;
    const double t = (*root + nearest) / length;
    if (!(t > low && t < high)) return std::nullopt;
    PatchHit hit;
    hit.t = t;
    const glm::dvec3 at = from + way * *root;
    const double height = glm::dot(at, patch.v);
    const glm::dvec3 flat = at - patch.v * height;
    const double away = glm::length(flat);
    const glm::dvec3 out = flat / away;
    const double angle = turnOf(height, away - ring) * tau;
    hit.a = turnOf(glm::dot(out, patch.u), glm::dot(out, patch.normal));
    hit.b = std::clamp((angle + patch.radius1 / ring * std::sin(angle)) / tau, 0.0, 1.0);
    hit.point.s = patch.lengthU * hit.a;
    hit.point.t = patch.lengthV * angle / tau;
    hit.point.position = ray.at(t);
    hit.point.normal = out * std::cos(angle) + patch.v * std::sin(angle);
    return hit;
}

}  // namespace

std::optional<PatchHit> intersect(const Patch& patch, const Ray& ray, double low, double high,
                                  double offset) {
    switch (patch.shape) {
        case Patch::Shape::Trapezoid:
            return meetTrapezoid(patch, ray, low, high, offset);
        case Patch::Shape::Tube:
            return meetTube(patch, ray, low, high, offset);
        case Patch::Shape::Ball:
            return meetBall(patch, ray, low, high, offset);
        case Patch::Shape::Disc:
            return meetDisc(patch, ray, low, high, offset);
        case Patch::Shape::Torus:
            return meetTorus(patch, ray, low, high, offset);
    }
    return std::nullopt;
}

}  // namespace scancast
