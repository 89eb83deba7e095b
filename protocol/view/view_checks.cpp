#include "protocol/view/view_checks.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "protocol/nearest_name.hpp"
#include "protocol/view/view_values.hpp"

namespace scancast::checks {
namespace {

constexpr double leastAngle = 1e-6;         // radians between up and the view direction
constexpr double rotationTolerance = 1e-4;  // clients may have computed in single precision
constexpr std::size_t longestName = 64;
constexpr std::size_t longestValue = 256;
constexpr std::size_t mostParameters = 64;

tl::unexpected<Error> impossible(std::string_view word, std::string message) {
    return fail(ErrorCode::ImpossibleView, std::move(message), std::string(word));
}

tl::unexpected<Error> invalid(std::string_view word, std::string message) {
    return fail(ErrorCode::InvalidArgument, std::move(message), std::string(word));
}

Expected<void> allCoordinates(std::string_view word, std::span<const double> values) {
    for (const double value : values) {
        if (!std::isfinite(value))
            return impossible(word, std::string(word) + " has a coordinate that is not a finite number");
        if (std::abs(value) > farthestCoordinate)
            return impossible(word, std::string(word) + " has a coordinate beyond 1e12");
    }
    return {};
}

/// Safe for the tiniest vectors, whose squares would vanish; zero for zero.
glm::dvec3 direction(const glm::dvec3& vector) {
    const double largest = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
    return largest > 0 ? glm::normalize(vector / largest) : glm::dvec3(0);
}

Expected<void> lookAt(const Camera& camera) {
    const auto forward = direction(camera.target - camera.eye);
    if (forward == glm::dvec3(0))
        return impossible("target", "eye and target are the same point, so there is no direction to look in");
    const auto up = direction(camera.up);
    if (up == glm::dvec3(0)) return impossible("up", "up is 0,0,0, so there is no upward direction");
    if (glm::length(glm::cross(forward, up)) < leastAngle)
        return impossible("up", "up is parallel to the direction from eye to target; try 0,1,0");
    return {};
}

/// Of the n-th shape, counted from 1.
Expected<void> clipShape(std::string_view word, std::size_t n, const ClipShape& shape) {
    const auto what = [&](const char* kind) {
        return std::string(word) + ": shape " + std::to_string(n) + ", a " + kind + ", ";
    };
    if (const auto* const half = std::get_if<HalfSpace>(&shape)) {
        for (const auto& v : {half->point, half->normal})
            if (auto ok = coordinates(word, v); !ok) return ok;
        if (half->normal == glm::dvec3(0))
            return invalid(word,
                           what("plane") + "has the normal 0,0,0; it must point to the side that is kept");
        return {};
    }
    const auto& box = std::get<TurnedBox>(shape);
    for (const auto& v : {box.center, box.size, box.turn})
        if (auto ok = coordinates(word, v); !ok) return ok;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(box.size[axis] > 0))
            return invalid(word, what("box") + "has a size that is not above 0; write its full lengths");
        if (!(std::abs(box.turn[axis]) <= 360))
            return invalid(word, what("box") + "is turned by more than 360 degrees");
    }
    return {};
}

bool isParameterName(std::string_view text) {
    return !text.empty() && text.size() <= longestName && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    });
}

bool isCloudName(std::string_view text) {
    return !text.empty() && text.size() <= longestCloudName && std::ranges::none_of(text, [](char c) {
        return c == ',' || c == ';' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    });
}

}  // namespace

Expected<void> coordinates(std::string_view word, const glm::dvec3& value) {
    return allCoordinates(word, std::span(&value.x, 3));
}

Expected<void> matrix(std::string_view word, const std::array<double, 16>& m) {
    if (auto ok = allCoordinates(word, m); !ok) return ok;
    const glm::dvec3 x(m[0], m[1], m[2]), y(m[4], m[5], m[6]), z(m[8], m[9], m[10]);
    const auto near = [](double value, double wanted) {
        return std::abs(value - wanted) <= rotationTolerance;
    };
    const bool rotation = near(glm::dot(x, x), 1) && near(glm::dot(y, y), 1) && near(glm::dot(z, z), 1) &&
                          near(glm::dot(x, y), 0) && near(glm::dot(y, z), 0) && near(glm::dot(z, x), 0) &&
                          glm::dot(glm::cross(x, y), z) > 0;
    if (!rotation)
        return impossible(word,
                          "viewMatrix must rotate and move, without scaling, shearing or mirroring (16 "
                          "numbers, column by column, world to view)");
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        return impossible(word, "the last row of viewMatrix must be 0 0 0 1; is it written row by row?");
    return {};
}

Expected<void> clipBox(std::string_view word, const ClipBox& box) {
    for (const auto& corner : {box.min, box.max})
        if (auto ok = coordinates(word, corner); !ok) return ok;
    for (int axis = 0; axis < 3; ++axis)
        if (box.min[axis] > box.max[axis])
            return invalid(
                word, "the clip box's minimum lies above its maximum; write xmin,ymin,zmin,xmax,ymax,zmax");
    return {};
}

Expected<void> clipShapes(std::string_view word, const ClipShapes& shapes) {
    if (shapes.size() > mostClipShapes)
        return invalid(
            word, std::string(word) + ": there are more than " + std::to_string(mostClipShapes) + " shapes");
    for (std::size_t i = 0; i < shapes.size(); ++i)
        if (auto ok = clipShape(word, i + 1, shapes[i]); !ok) return ok;
    return {};
}

Expected<void> viewedClouds(std::string_view word, const ViewedClouds& clouds) {
    if (clouds.size() > mostViewedClouds)
        return invalid(
            word, std::string(word) + ": there are more than " + std::to_string(mostViewedClouds) + " clouds");
    if (std::ranges::count(clouds, ownCloudName, &ViewedCloud::cloud) > 1)
        return invalid(word, std::string(word) + ": the view's own cloud, \".\", stands there twice");
    for (const ViewedCloud& one : clouds) {
        if (!isCloudName(one.cloud))
            return invalid(word, std::string(word) + ": " + quoteText(one.cloud) +
                                     " is no cloud's name; one has 1 to 255 bytes, without commas, "
                                     "semicolons and control characters");
        if (auto ok = coordinates(word, one.shift); !ok) return ok;
    }
    return {};
}

Expected<void> ends(std::string_view word, const std::array<double, 2>& range) {
    const auto [low, high] = range;
    if (std::isfinite(low) && std::isfinite(high) && low < high) return {};
    return invalid(word, "range needs two finite numbers, the lower one first");
}

// Written so that NaN fails and is refused.
Expected<void> sun(std::string_view word, const std::array<double, 2>& direction) {
    const auto [azimuth, elevation] = direction;
    if (!(azimuth >= -360 && azimuth <= 360))
        return invalid(word, std::string(word) + ": the azimuth must lie between -360 and 360 degrees");
    if (!(elevation >= 0 && elevation <= 90))
        return invalid(word, std::string(word) + ": the elevation must lie between 0 and 90 degrees");
    return {};
}

Expected<void> method(std::string_view word, const std::string& name) {
    if (!name.empty() && name.size() <= longestName) return {};
    return invalid(word, "a method's name has 1 to 64 characters");
}

namespace {

Expected<void> columnName(std::string_view word, std::string_view name) {
    if (!name.empty() && name.size() <= longestColumnName) return {};
    return invalid(word, std::string(word) + ": a column's name has 1 to " +
                             std::to_string(longestColumnName) + " bytes");
}

}  // namespace

Expected<void> columnRanges(std::string_view word, const ColumnRanges& ranges) {
    if (ranges.size() > mostColumnRanges)
        return invalid(
            word, std::string(word) + ": there are more than " + std::to_string(mostColumnRanges) + " ranges");
    for (const ColumnRange& range : ranges) {
        if (auto ok = columnName(word, range.column); !ok) return ok;
        const std::string what = std::string(word) + ": the range of " + quoteText(range.column);
        if (!range.low && !range.high) return invalid(word, what + " has neither a low nor a high end");
        for (const auto& end : {range.low, range.high})
            if (end && !std::isfinite(*end)) return invalid(word, what + " has an end that is not finite");
        if (range.low && range.high && *range.low > *range.high)
            return invalid(word, what + " has its low end above its high one");
    }
    return {};
}

Expected<void> color(std::string_view word, const Style& style) {
    if (style.color == ColorSource::Column) return columnName(word, style.column);
    if (const auto known = values::parse<values::Color>(colorWord(style)); !known)
        return invalid(word, known.error());
    return {};
}

Expected<void> colormap(std::string_view word, const std::string& name) {
    if (const auto known = values::parseColormap(name); !known) return invalid(word, known.error());
    return {};
}

Expected<void> parameters(const ParameterValues& parameters) {
    if (parameters.size() > mostParameters) return invalid("param", "there are more than 64 parameters");
    for (const auto& [key, value] : parameters) {
        if (!isParameterName(key))
            return invalid("param",
                           "a parameter's name has 1 to 64 letters and digits, unlike " + quoteText(key));
        const auto word = "param." + key;
        const auto* number = std::get_if<double>(&value);
        if (number && !std::isfinite(*number)) return invalid(word, word + " is not a finite number");
        const auto* text = std::get_if<std::string>(&value);
        if (text && text->size() > longestValue) return invalid(word, word + " is longer than 256 bytes");
    }
    return {};
}

// Written so that NaN fails and is refused.
Expected<void> inRange(std::string_view word, double value, const ViewRange& range) {
    if (value >= range.least && value <= range.most) return {};
    return fail(range.code, std::string(word) + " must " + std::string(range.must), std::string(word));
}

Expected<void> camera(const Camera& camera) {
    if (!camera.viewMatrix)
        if (auto ok = lookAt(camera); !ok) return ok;
    if (camera.near && camera.far && !(*camera.near < *camera.far))
        return impossible("near", "near must be less than far");
    return {};
}

}  // namespace scancast::checks
