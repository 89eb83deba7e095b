#include "importers/e57/scan_description.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

namespace {

constexpr double mostFinite = 1e300;  ///< what writers put where there is no limit is beyond it
constexpr std::size_t mostFields = 512;

tl::unexpected<Error> malformed(const std::string& called, const std::string& reason) {
    return fail(ErrorCode::Malformed, called + ": " + reason);
}

std::optional<Limits> limitsOf(std::optional<double> minimum, std::optional<double> maximum) {
    if (!minimum || !maximum) return std::nullopt;
    const bool sound =
        std::abs(*minimum) < mostFinite && std::abs(*maximum) < mostFinite && *minimum < *maximum;
    return sound ? std::optional(Limits{*minimum, *maximum}) : std::nullopt;
}

std::optional<Limits> limitsOf(const XmlElement& parent, const std::string& name) {
    return limitsOf(valueOf(parent, name + "Minimum"), valueOf(parent, name + "Maximum"));
}

Expected<Field> describeField(const XmlElement& element, const std::string& called) {
    Field field;
    field.name = printableText(element.name, 64);
    const auto type = element.attribute("type");
    const auto wrong = [&](std::string_view attribute) {
        return malformed(called,
                         fmt::format("the {} of its field {} is {}", attribute, quotedText(element.name),
                                     quotedText(element.attribute(attribute))));
    };
    if (type == "Float") {
        field.encoding = element.attribute("precision") == "single" ? Encoding::Float32 : Encoding::Float64;
        field.bits = field.encoding == Encoding::Float32 ? 32 : 64;
        if (!element.attribute("minimum").empty() && !element.attribute("maximum").empty())
            field.limits = limitsOf(numberIn<double>(element.attribute("minimum"), 0.0),
                                    numberIn<double>(element.attribute("maximum"), 0.0));
        return field;
    }
    if (type != "Integer" && type != "ScaledInteger") {
        field.encoding = Encoding::Other;
        return field;
    }
    field.encoding = type == "Integer" ? Encoding::Integer : Encoding::ScaledInteger;
    using Integers = std::numeric_limits<std::int64_t>;
    const auto minimum = numberIn(element.attribute("minimum"), Integers::min());
    const auto maximum = numberIn(element.attribute("maximum"), Integers::max());
    if (!minimum) return wrong("minimum");
    if (!maximum || *maximum < *minimum) return wrong("maximum");
    field.minimum = *minimum;
    field.maximum = *maximum;
    field.bits = static_cast<unsigned>(
        std::bit_width(static_cast<std::uint64_t>(*maximum) - static_cast<std::uint64_t>(*minimum)));
    if (field.encoding == Encoding::ScaledInteger) {
        const auto scale = numberIn(element.attribute("scale"), 1.0);
        const auto offset = numberIn(element.attribute("offset"), 0.0);
        if (!scale || !std::isfinite(*scale) || *scale == 0) return wrong("scale");
        if (!offset || !std::isfinite(*offset)) return wrong("offset");
        field.scale = *scale;
        field.offset = *offset;
    }
    const double low = static_cast<double>(field.minimum) * field.scale + field.offset;
    const double high = static_cast<double>(field.maximum) * field.scale + field.offset;
    field.limits = limitsOf(std::min(low, high), std::max(low, high));
    return field;
}

Expected<void> describePoints(const XmlElement& points, const std::string& called, ScanDescription& scan) {
    const auto records = numberIn<std::uint64_t>(points.attribute("recordCount"), 0);
    const auto section = numberIn<std::uint64_t>(points.attribute("fileOffset"), 0);
    if (!records)
        return malformed(called, "its number of points is " + quotedText(points.attribute("recordCount")));
    if (!section)
        return malformed(called, "its points' offset is " + quotedText(points.attribute("fileOffset")));
    scan.records = *records;
    scan.section = *section;
    const auto* const prototype = points.child("prototype");
    if (prototype == nullptr)
        return malformed(called, "it does not say of what its points consist (\"prototype\")");
    if (prototype->children.size() > mostFields)
        return malformed(called, fmt::format("its points have more than {} fields", mostFields));
    for (const auto& element : prototype->children) {
        if (!element.children.empty())
            return fail(ErrorCode::Unsupported, called + ": its field " + quotedText(element.name) +
                                                    " consists of others; such files are not known");
        auto field = describeField(element, called);
        if (!field) return passOn(field);
        const auto index = static_cast<int>(scan.fields.size());
        const auto role = roleOf(element.name);
        if (role && scan.fieldOf.has(*role))
            return malformed(called, "two of its fields are called " + quotedText(element.name));
        if (role && field->encoding != Encoding::Other) scan.fieldOf[*role] = index;
        scan.fields.push_back(std::move(*field));
    }
    return {};
}

void describeLimits(const XmlElement& element, ScanDescription& scan) {
    if (const auto* const limits = element.child("intensityLimits"))
        scan.intensity = limitsOf(*limits, "intensity");
    if (const auto* const limits = element.child("colorLimits"))
        for (std::size_t i = 0; i < 3; ++i)
            scan.color[i] = limitsOf(*limits, std::array{"colorRed", "colorGreen", "colorBlue"}[i]);
    if (const auto* const bounds = element.child("cartesianBounds")) {
        std::array<glm::dvec3, 2> box{};
        bool whole = true;
        for (int i = 0; i < 3; ++i) {
            const std::string axis(1, "xyz"[i]);
            const auto low = valueOf(*bounds, axis + "Minimum"), high = valueOf(*bounds, axis + "Maximum");
            whole &= low && high && std::abs(*low) < 1e15 && std::abs(*high) < 1e15 && *low <= *high;
            box[0][i] = low.value_or(0);
            box[1][i] = high.value_or(0);
        }
        if (whole) scan.bounds = box;
    }
    if (const auto* const bounds = element.child("sphericalBounds"))
        scan.hasSphericalBounds = valueOf(*bounds, "rangeMinimum").value_or(0) > 0;
}

}  // namespace

Expected<Pose> describePose(const XmlElement& element, const std::string& called) {
    Pose pose;
    std::array<double, 4> q{1, 0, 0, 0};
    const auto read = [](const XmlElement& parent, const char* name, double& into) {
        if (parent.child(name) == nullptr) return true;
        const auto value = valueOf(parent, name);
        into = value.value_or(0);
        return value && std::abs(*value) < 1e15;
    };
    bool sound = true;
    if (const auto* const rotation = element.child("rotation")) {
        q[0] = 0;
        for (std::size_t i = 0; i < 4; ++i) sound &= read(*rotation, std::array{"w", "x", "y", "z"}[i], q[i]);
    }
    if (const auto* const translation = element.child("translation"))
        for (int i = 0; i < 3; ++i)
            sound &= read(*translation, std::array{"x", "y", "z"}[static_cast<std::size_t>(i)],
                          pose.translation[i]);
    if (!sound) return malformed(called, "its pose is no rotation and translation");
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    pose.wasZero = !(length > 1e-12);
    if (pose.wasZero) return pose;
    pose.wasLong = std::abs(length - 1) > 1e-3;
    for (auto& value : q) value /= length;
    const auto [w, x, y, z] = q;
    pose.rotates = x != 0 || y != 0 || z != 0;
    if (!pose.rotates) return pose;
    pose.rotation = glm::dmat3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),  //
                               2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),  //
                               2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));
    return pose;
}

bool ScanDescription::standsAtOrigin() const {
    if (fieldOf.spherical()) return true;
    const bool grid = fieldOf.has(Role::Row) && fieldOf.has(Role::Column);
    return (grid && (pose || hasSphericalBounds)) || (pose && (pose->rotates || besideTurned));
}

Expected<ScanDescription> describeScan(const XmlElement& scan, const std::string& called) {
    ScanDescription result;
    if (const auto* const name = scan.child("name")) result.name = printableText(name->text, 80);
    if (const auto* const guid = scan.child("guid")) result.guid = guid->text;
    if (const auto* const points = scan.child("points"))
        if (auto ok = describePoints(*points, called, result); !ok) return passOn(ok);
    if (const auto* const element = scan.child("pose")) {
        auto pose = describePose(*element, called);
        if (!pose) return passOn(pose);
        result.pose = *pose;
    }
    describeLimits(scan, result);
    return result;
}

}  // namespace scancast::import_e57
