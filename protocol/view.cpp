#include "protocol/view.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "protocol/nearest_name.hpp"
#include "protocol/view_values.hpp"

namespace scancast {
namespace {

/// Beyond it not even doubles tell neighbouring points apart, and squares come near their end.
constexpr double farthestCoordinate = 1e12;
constexpr double leastAngle = 1e-6;         // radians between up and the view direction
constexpr double rotationTolerance = 1e-4;  // clients may have computed in single precision
constexpr double maxDetail = 1024;
/// Below these, sizes in pixels run out of every number format; nothing to see is lost.
constexpr double leastFov = 1e-6;     // degrees
constexpr double leastLength = 1e-9;  // cloud units
constexpr std::size_t longestName = 64;
constexpr std::size_t longestValue = 256;
constexpr std::size_t mostParameters = 64;

tl::unexpected<Error> impossible(std::string_view word, std::string message) {
    return fail(ErrorCode::ImpossibleView, std::move(message), std::string(word));
}

tl::unexpected<Error> invalid(std::string_view word, std::string message) {
    return fail(ErrorCode::InvalidArgument, std::move(message), std::string(word));
}

Expected<void> checkCoordinates(std::string_view word, std::span<const double> values) {
    for (const double value : values) {
        if (!std::isfinite(value))
            return impossible(word, std::string(word) + " has a coordinate that is not a finite number");
        if (std::abs(value) > farthestCoordinate)
            return impossible(word, std::string(word) + " has a coordinate beyond 1e12");
    }
    return {};
}

Expected<void> checkCoordinates(std::string_view word, const glm::dvec3& value) {
    return checkCoordinates(word, std::span(&value.x, 3));
}

/// Safe for the tiniest vectors, whose squares would vanish; zero for zero.
glm::dvec3 direction(const glm::dvec3& vector) {
    const double largest = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
    return largest > 0 ? glm::normalize(vector / largest) : glm::dvec3(0);
}

Expected<void> checkLookAt(const Camera& camera) {
    for (const auto& [word, value] : {std::pair<std::string_view, const glm::dvec3&>{"eye", camera.eye},
                                      {"target", camera.target},
                                      {"up", camera.up}})
        if (auto sound = checkCoordinates(word, value); !sound) return sound;
    const auto forward = direction(camera.target - camera.eye);
    if (forward == glm::dvec3(0))
        return impossible("target", "eye and target are the same point, so there is no direction to look in");
    const auto up = direction(camera.up);
    if (up == glm::dvec3(0)) return impossible("up", "up is 0,0,0, so there is no upward direction");
    if (glm::length(glm::cross(forward, up)) < leastAngle)
        return impossible("up", "up is parallel to the direction from eye to target; try 0,1,0");
    return {};
}

Expected<void> checkMatrix(const std::array<double, 16>& m) {
    if (auto sound = checkCoordinates("viewMatrix", m); !sound) return sound;
    const glm::dvec3 x(m[0], m[1], m[2]), y(m[4], m[5], m[6]), z(m[8], m[9], m[10]);
    const auto near = [](double value, double wanted) {
        return std::abs(value - wanted) <= rotationTolerance;
    };
    const bool rotation = near(glm::dot(x, x), 1) && near(glm::dot(y, y), 1) && near(glm::dot(z, z), 1) &&
                          near(glm::dot(x, y), 0) && near(glm::dot(y, z), 0) && near(glm::dot(z, x), 0) &&
                          glm::dot(glm::cross(x, y), z) > 0;
    if (!rotation)
        return impossible(
            "viewMatrix",
            "viewMatrix must rotate and move, without scaling, shearing or mirroring (16 numbers, column "
            "by column, world to view)");
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        return impossible("viewMatrix",
                          "the last row of viewMatrix must be 0 0 0 1; is it written row by row?");
    return {};
}

Expected<void> checkCamera(const Camera& camera) {
    if (auto sound = camera.viewMatrix ? checkMatrix(*camera.viewMatrix) : checkLookAt(camera); !sound)
        return sound;
    // Written so that NaN fails every comparison and is refused.
    if (camera.projection == Projection::Perspective) {
        if (!(camera.fov >= leastFov && camera.fov < 180))
            return impossible("fov", "fov must lie between 0 and 180 degrees, both excluded");
    } else if (!(camera.viewHeight >= leastLength && camera.viewHeight <= farthestCoordinate)) {
        return impossible("viewHeight", "viewHeight must be above 0, in the cloud's unit");
    }
    if (camera.near && !(*camera.near >= leastLength && *camera.near <= farthestCoordinate))
        return impossible("near", "near must be above 0, in the cloud's unit");
    if (camera.far && !(*camera.far >= leastLength && *camera.far <= farthestCoordinate))
        return impossible("far", "far must be above 0, in the cloud's unit");
    if (camera.near && camera.far && !(*camera.near < *camera.far))
        return impossible("near", "near must be less than far");
    return {};
}

bool isParameterName(std::string_view text) {
    return !text.empty() && text.size() <= longestName && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    });
}

Expected<void> checkParameters(const ParameterValues& parameters) {
    if (parameters.size() > mostParameters) return invalid("param", "there are more than 64 parameters");
    for (const auto& [key, value] : parameters) {
        if (!isParameterName(key))
            return invalid("param",
                           "a parameter's name has 1 to 64 letters and digits, unlike " + quoteText(key));
        const auto* number = std::get_if<double>(&value);
        if (number && !std::isfinite(*number))
            return invalid("param." + key, "param." + key + " is not a finite number");
        const auto* text = std::get_if<std::string>(&value);
        if (text && text->size() > longestValue)
            return invalid("param." + key, "param." + key + " is longer than 256 bytes");
    }
    return {};
}

Expected<void> checkStyleValues(const Style& style) {
    if (style.method.empty() || style.method.size() > longestName)
        return invalid("method", "a method's name has 1 to 64 characters");
    if (auto sound = checkParameters(style.parameters); !sound) return sound;
    if (const auto known = values::colormap(style.colormap); !known)
        return invalid("colormap", known.error());
    if (style.range) {
        const auto [low, high] = *style.range;
        if (!(std::isfinite(low) && std::isfinite(high) && low < high))
            return invalid("range", "range needs two finite numbers, the lower one first");
    }
    if (style.clip) {
        if (auto sound = checkCoordinates("clip", style.clip->min); !sound) return sound;
        if (auto sound = checkCoordinates("clip", style.clip->max); !sound) return sound;
        for (int axis = 0; axis < 3; ++axis)
            if (style.clip->min[axis] > style.clip->max[axis])
                return invalid(
                    "clip",
                    "the clip box's minimum lies above its maximum; write xmin,ymin,zmin,xmax,ymax,zmax");
    }
    return {};
}

Expected<void> checkQuality(const Quality& quality) {
    if (quality.detail && !(*quality.detail >= 0 && *quality.detail <= maxDetail))
        return invalid("detail", "detail must lie between 0 and 1024 px");
    if (quality.budget && *quality.budget == 0) return invalid("budget", "budget must be at least 1 sample");
    if (quality.samples && (*quality.samples < 1 || *quality.samples > 64))
        return invalid("samples", "samples must lie between 1 and 64");
    if (quality.jpegQuality < 1 || quality.jpegQuality > 100)
        return invalid("quality", "quality must lie between 1 and 100");
    return {};
}

}  // namespace

Expected<void> validate(const View& view) {
    for (const auto& [word, side] :
         {std::pair<std::string_view, int>{"width", view.width}, {"height", view.height}})
        if (side < 1 || side > maxPictureSide)
            return invalid(word, std::string(word) + " must lie between 1 and 16384 px");
    if (auto sound = checkCamera(view.camera); !sound) return sound;
    if (auto sound = checkStyleValues(view.style); !sound) return sound;
    return checkQuality(view.quality);
}

std::string_view name(Projection projection) {
    return projection == Projection::Perspective ? "perspective" : "orthographic";
}

std::string_view name(ColorSource source) {
    switch (source) {
        case ColorSource::Rgb:
            return "rgb";
        case ColorSource::Intensity:
            return "intensity";
        case ColorSource::Elevation:
            return "elevation";
        case ColorSource::Classification:
            return "classification";
        case ColorSource::Normal:
            return "normal";
        case ColorSource::Depth:
            return "depth";
        case ColorSource::Lod:
            return "lod";
        case ColorSource::Flat:
            return "flat";
    }
    return "flat";
}

std::string_view name(Shading shading) {
    switch (shading) {
        case Shading::Unlit:
            return "unlit";
        case Shading::Phong:
            return "phong";
        case Shading::EyeDome:
            return "eyedome";
    }
    return "unlit";
}

std::string_view name(Subsampling subsampling) {
    switch (subsampling) {
        case Subsampling::S444:
            return "4:4:4";
        case Subsampling::S422:
            return "4:2:2";
        case Subsampling::S420:
            return "4:2:0";
    }
    return "4:2:0";
}

}  // namespace scancast
