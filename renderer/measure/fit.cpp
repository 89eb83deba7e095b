#include "renderer/measure/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numbers>

#include "protocol/measure/principal_axes.hpp"
#include "protocol/measure/vertices.hpp"
#include "renderer/measure/robust.hpp"
#include "renderer/measure/shapes.hpp"

namespace scancast {
namespace {

// Starts are looked for among few points; all are refined.
constexpr std::size_t startPoints = 400, axisPoints = 200;
constexpr int startTries = 300, axisTries = 24, directions = 200;
constexpr std::size_t refinedAxes = 8;
constexpr int roundsOfStart = 30, rounds = 40;

std::size_t fewestOf(MeasureKind kind) {
    return kind == MeasureKind::Cylinder ? 8 : kind == MeasureKind::Sphere ? 5 : 4;
}

tl::unexpected<Error> tooFew(MeasureKind kind, std::uint64_t points) {
    return fail(
        ErrorCode::Empty,
        fmt::format(
            "{} of the scan's points that the view draws lie within that distance of these places, and "
            "a {} needs {} at least; say a larger within",
            points == 0 ? "none" : "only " + std::to_string(points), name(kind), fewestOf(kind)));
}

tl::unexpected<Error> unlike(MeasureKind kind) {
    return fail(ErrorCode::Empty,
                fmt::format("the points there do not look like a {}; pick other places, or another within",
                            name(kind)));
}

/// Degrees around the axis that have used points, five by five.
template <class Fit>
double arcOf(const Fit& fit, std::span<const glm::dvec3> points) {
    constexpr std::size_t parts = 72;
    std::array<std::uint64_t, parts> counts{};
    const auto [u, v] = across(fit.shape.axis);
    for (const glm::dvec3& p : points) {
        if (!fit.uses(p)) continue;
        const glm::dvec3 q = p - fit.shape.center;
        const double turn = std::atan2(glm::dot(q, v), glm::dot(q, u)) / (2 * std::numbers::pi) + 0.5;
        ++counts[std::min(parts - 1, std::size_t(turn * double(parts)))];
    }
    // What strayed onto the shape is no arc of it: a part has a fifth of what is there on average, at least.
    const auto isSeen = [&](std::uint64_t count) { return count > 0 && count * 5 * parts >= fit.used; };
    return double(std::ranges::count_if(counts, isSeen)) * 360 / double(parts);
}

/// The middle of the used points along the axis, and how long they are.
template <class Fit>
std::array<double, 2> extentOf(const Fit& fit, std::span<const glm::dvec3> points) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const glm::dvec3& p : points) {
        if (!fit.uses(p)) continue;
        const double along = glm::dot(p - fit.shape.center, fit.shape.axis);
        low = std::min(low, along), high = std::max(high, along);
    }
    return {(low + high) / 2, high - low};
}

template <class Fit>
ShapeMeasure roundShape(const Fit& fit, std::span<const glm::dvec3> points) {
    ShapeMeasure shape;
    const auto [middle, length] = extentOf(fit, points);
    shape.center = fit.shape.center + middle * fit.shape.axis;
    shape.axis = upwards(fit.shape.axis);
    shape.radius = fit.shape.radius;
    shape.length = length;
    shape.arc = arcOf(fit, points);
    shape.rms = fit.rms;
    shape.used = fit.used;
    return shape;
}

/// A fit that is no shape: numbers ran away, or hardly a point is on it.
template <class Fit>
bool isPoor(const Fit& fit, std::size_t points, double radius, double extent) {
    return !(radius > 0) || !(radius < 1000 * extent) || fit.used * 5 < points;
}

Expected<ShapeMeasure> fitPlane(std::span<const glm::dvec3> points, double finest) {
    double least = 0;
    const auto start = leastMedian<FittedPlane>(evenly(points, startPoints), FittedPlane::points, startTries,
                                                FittedPlane::through, least);
    if (!start) return unlike(MeasureKind::Plane);
    auto fit = refine(*start, points, finest, rounds);
    ShapeMeasure shape;
    glm::dvec3 sum(0);
    for (const glm::dvec3& p : points)
        if (fit.uses(p)) sum += p;
    const glm::dvec3 middle = sum / double(std::max<std::uint64_t>(1, fit.used));
    shape.center = middle - fit.shape.residual(middle) * fit.shape.normal;
    shape.axis = upwards(fit.shape.normal);
    shape.rms = fit.rms;
    shape.used = fit.used;
    return shape;
}

Expected<ShapeMeasure> fitSphere(std::span<const glm::dvec3> points, double finest, double extent) {
    double least = 0;
    const auto start = leastMedian<FittedSphere>(evenly(points, startPoints), FittedSphere::points,
                                                 startTries, FittedSphere::through, least);
    if (!start) return unlike(MeasureKind::Sphere);
    const auto fit = refine(*start, points, finest, rounds);
    if (isPoor(fit, points.size(), fit.shape.radius, extent)) return unlike(MeasureKind::Sphere);
    ShapeMeasure shape;
    shape.center = fit.shape.center;
    shape.radius = fit.shape.radius;
    shape.rms = fit.rms;
    shape.used = fit.used;
    return shape;
}

Expected<ShapeMeasure> fitCircle(std::span<const glm::dvec3> points, const glm::dvec3& axis, double finest,
                                 double extent) {
    double least = 0;
    const auto start = leastMedian<FittedCircle>(
        evenly(points, startPoints), FittedCircle::points, startTries,
        [&](std::span<const glm::dvec3> few) { return FittedCircle::through(few, axis); }, least);
    if (!start) return unlike(MeasureKind::Circle);
    const auto fit = refine(*start, points, finest, rounds);
    if (isPoor(fit, points.size(), fit.shape.radius, extent)) return unlike(MeasureKind::Circle);
    ShapeMeasure shape = roundShape(fit, points);
    shape.length = 0;
    return shape;
}

/// All over half a sphere, and the directions in which the points lie.
std::vector<glm::dvec3> axesToTry(std::span<const glm::dvec3> points) {
    const PrincipalAxes own = principalAxes(points);
    std::vector<glm::dvec3> axes(own.axes.begin(), own.axes.end());
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < directions; ++i) {
        const double z = (i + 0.5) / directions, r = std::sqrt(1 - z * z);
        axes.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
    }
    return axes;
}

/// The axis is unknown: for each of many, the circle that most points lie on when they are seen along it; the best of these are refined.
Expected<ShapeMeasure> fitCylinder(std::span<const glm::dvec3> points, double finest, double extent) {
    const auto few = evenly(points, axisPoints), more = evenly(points, 4 * startPoints);
    std::vector<std::pair<double, FittedCylinder>> starts;
    for (const glm::dvec3& axis : axesToTry(few)) {
        double least = 0;
        const auto circle = leastMedian<FittedCircle>(
            few, FittedCircle::points, axisTries,
            [&](std::span<const glm::dvec3> three) { return FittedCircle::through(three, axis); }, least);
        if (circle && circle->radius < 10 * extent)
            starts.emplace_back(least, FittedCylinder{axis, circle->center, circle->radius});
    }
    std::ranges::stable_sort(starts, {}, [](const auto& start) { return start.first; });
    if (starts.size() > refinedAxes) starts.resize(refinedAxes);
    std::optional<FittedCylinder> best;
    double least = 0;
    std::vector<double> room;
    for (const auto& [median, start] : starts) {
        const FittedCylinder shape = refine(start, more, finest, roundsOfStart).shape;
        const double now = medianResidual(shape, more, room);
        if (best && !(now < least)) continue;
        best = shape;
        least = now;
    }
    if (!best) return unlike(MeasureKind::Cylinder);
    const auto fit = refine(*best, points, finest, rounds);
    if (isPoor(fit, points.size(), fit.shape.radius, extent)) return unlike(MeasureKind::Cylinder);
    return roundShape(fit, points);
}

/// The circle's: as it is said; else at right angles to the plane of the picked points; else upright.
Expected<glm::dvec3> circleAxis(const MeasureRequest& request) {
    if (request.axis) return glm::normalize(*request.axis);
    if (request.points.size() < 3) return glm::dvec3(0, 0, 1);
    const PrincipalAxes axes = principalAxes(request.points);
    if (!(axes.variances[1] > 1e-12 * axes.variances[2]))
        return fail(ErrorCode::InvalidArgument, "points: they lie on one line, which tells no circle",
                    "points");
    return axes.axes[0];
}

/// Through the picked points themselves.
Expected<ShapeMeasure> throughPicked(const MeasureRequest& request) {
    ShapeMeasure shape;
    shape.points = shape.fitted = shape.used = request.points.size();
    const auto axis = circleAxis(request);
    if (!axis) return passOn(axis);
    if (request.kind == MeasureKind::Plane) {
        const PrincipalAxes axes = principalAxes(request.points);
        shape.center = axes.center;
        shape.axis = upwards(*axis);
        shape.rms = std::sqrt(axes.variances[0]);
        return shape;
    }
    const glm::dvec3 from = request.points.front();
    std::vector<glm::dvec3> near;
    for (const glm::dvec3& p : request.points) near.push_back(p - from);
    const auto circle = FittedCircle::through(near, *axis);
    if (!circle)
        return fail(ErrorCode::InvalidArgument, "points: seen along the axis they lie on one line", "points");
    const RobustFit<FittedCircle> all{*circle, std::numeric_limits<double>::infinity(), 0, near.size()};
    const glm::dvec3 middle = (near[0] + near[1] + near[2]) / 3.0;
    shape.center = from + circle->center + glm::dot(middle - circle->center, *axis) * *axis;
    shape.axis = upwards(*axis);
    shape.radius = circle->radius;
    shape.arc = arcOf(all, near);
    return shape;
}

/// Points near the picked places, relative to the first of them; every so many-th where there are too many.
class NearPoints {
  public:
    NearPoints(std::span<const glm::dvec3> places, double within) : places_(places), within_(within) {}

    void add(const glm::dvec3& p) {
        const bool near = std::ranges::any_of(places_, [&](const glm::dvec3& place) {
            const glm::dvec3 d = p - place;
            return glm::dot(d, d) <= within_ * within_;
        });
        if (!near) return;
        if (count_++ % stride_ != 0) return;
        points_.push_back(p - places_.front());
        if (points_.size() < mostFittedPoints) return;
        stride_ *= 2;
        std::size_t to = 0;
        for (std::size_t i = 0; i < points_.size(); i += 2) points_[to++] = points_[i];
        points_.resize(to);
    }
    std::uint64_t count() const { return count_; }
    std::vector<glm::dvec3> take() { return std::move(points_); }

  private:
    std::span<const glm::dvec3> places_;
    const double within_;
    std::uint64_t count_ = 0, stride_ = 1;
    std::vector<glm::dvec3> points_;
};

}  // namespace

Expected<ShapeMeasure> fitShape(const MeasureRequest& request, std::vector<glm::dvec3> points,
                                double finest) {
    if (points.size() < fewestOf(request.kind)) return tooFew(request.kind, points.size());
    glm::dvec3 low = points.front(), high = low;
    for (const glm::dvec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
    const double extent = glm::length(high - low);
    switch (request.kind) {
        case MeasureKind::Circle: {
            const auto axis = circleAxis(request);
            if (!axis) return passOn(axis);
            return fitCircle(points, *axis, finest, extent);
        }
        case MeasureKind::Sphere:
            return fitSphere(points, finest, extent);
        case MeasureKind::Cylinder:
            return fitCylinder(points, finest, extent);
        default:
            return fitPlane(points, finest);
    }
}

Expected<ShapeMeasure> measureShape(const Cloud& cloud, const SampleFilter& filter,
                                    const MeasureRequest& request, double heightScale,
                                    const std::stop_token& stop) {
    const glm::dvec3 unit(1, 1, heightScale);
    MeasureRequest scaled = request;
    for (glm::dvec3& p : scaled.points) p *= unit;
    const auto finished = [&](Expected<ShapeMeasure> shape, const glm::dvec3& from) {
        if (!shape) return shape;
        shape->kind = request.kind;
        shape->center = (shape->center + from) / unit;
        return shape;
    };
    if (!request.within) return finished(throughPicked(scaled), glm::dvec3(0));
    MeasuredBox box{request.points.front(), request.points.front()};
    for (const glm::dvec3& p : request.points) {
        box.low = glm::min(box.low, p - *request.within / unit);
        box.high = glm::max(box.high, p + *request.within / unit);
    }
    NearPoints near(scaled.points, *request.within);
    auto ok = forLeafPoints(cloud, filter, box, stop, [&](std::span<const glm::dvec3> places) {
        for (const glm::dvec3& p : places) near.add(p * unit);
    });
    if (!ok) return passOn(ok);
    auto points = near.take();
    const std::uint64_t fitted = points.size();
    double finest = cloud.grid ? std::min({cloud.grid->step.x, cloud.grid->step.y, cloud.grid->step.z}) : 0;
    finest = std::max(finest / 4, 1e-9 * *request.within);
    auto shape = fitShape(scaled, std::move(points), finest);
    if (shape) {
        shape->points = near.count();
        shape->fitted = fitted;
    }
    return finished(std::move(shape), scaled.points.front());
}

}  // namespace scancast
