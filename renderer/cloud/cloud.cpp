#include "renderer/cloud/cloud.hpp"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "protocol/json_text.hpp"
#include "protocol/text/plain_text.hpp"

namespace scancast {

namespace {

/// Models, unlike surveys, are mostly made with Y up, and set down on the plane y = 0 around the origin.
bool standsOnXZ(const std::array<glm::dvec3, 2>& bounds) {
    const glm::dvec3 size = bounds[1] - bounds[0];
    const auto standsOn = [&](int axis) { return std::abs(bounds[0][axis]) <= 0.02 * size[axis]; };
    const auto straddles = [&](int axis) { return bounds[0][axis] < 0 && bounds[1][axis] > 0; };
    return standsOn(1) && !standsOn(2) && straddles(0) && straddles(2);
}

/// "2024-05-13" → 2024, 5, 13; what is left out is 1. nullopt for anything else.
std::optional<std::chrono::year_month_day> dateOf(std::string_view text) {
    constexpr std::size_t yearOnly = 4, toMonth = 7, toDay = 10;
    if (text.size() != yearOnly && text.size() != toMonth && text.size() != toDay) return std::nullopt;
    unsigned parts[3] = {0, 1, 1};
    for (std::size_t i = 0, from = 0; from < text.size(); ++i) {
        const std::size_t to = i == 0 ? yearOnly : from + 2;
        if (to < text.size() && text[to] != '-') return std::nullopt;
        const auto [end, failed] = std::from_chars(text.data() + from, text.data() + to, parts[i]);
        if (failed != std::errc() || end != text.data() + to) return std::nullopt;
        from = to + 1;
    }
    return std::chrono::year_month_day(std::chrono::year(int(parts[0])), std::chrono::month(parts[1]),
                                       std::chrono::day(parts[2]));
}

}  // namespace

Expected<void> checkAttribution(std::string_view attribution) {
    if (attribution.size() > longestAttribution)
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("the attribution has {} bytes; it may have {}", attribution.size(),
                                longestAttribution),
                    "attribution");
    return {};
}

Expected<void> checkRecorded(std::string_view date) {
    if (const auto parsed = dateOf(date); date.empty() || (parsed && parsed->ok())) return {};
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("\"{}\" is no date; write 2024, 2024-05 or 2024-05-13", plainText(date.substr(0, 40))),
        "recorded");
}

ValuePlane curvaturePlane() {
    return {std::string(curvaturePlaneName), ColumnType::Uint32, ValuePlane::Of::Samples};
}

bool hasCurvature(const CloudFacts& facts) {
    return std::ranges::find(facts.companions, curvaturePlane()) != facts.companions.end();
}

ValuePlane nearInfraredPlane() {
    return {std::string(nearInfraredPlaneName), ColumnType::Uint8, ValuePlane::Of::Samples};
}

bool hasNearInfrared(const CloudFacts& facts) {
    return std::ranges::find(facts.companions, nearInfraredPlane()) != facts.companions.end();
}

ValuePlane innerPlane(const Column& column) {
    return {"inner:" + column.name, column.type, ValuePlane::Of::Samples};
}

std::vector<ValuePlane> planesOf(const CloudFacts& facts) {
    std::vector<ValuePlane> planes;
    for (const KeptColumn& kept : facts.columns)
        planes.push_back({kept.column.name, kept.column.type, ValuePlane::Of::Points});
    planes.insert(planes.end(), facts.companions.begin(), facts.companions.end());
    return planes;
}

std::vector<std::string> remarksOn(const CloudFacts& facts) {
    std::vector<std::string> remarks;
    if (facts.droppedPoints > 0)
        remarks.push_back(fmt::format("{} points without coordinates, or marked as none, were left out.",
                                      facts.droppedPoints));
    if (const auto& color = facts.constant.color)
        remarks.push_back(fmt::format("All points have the same colour, {} {} {}: that is taken for none.",
                                      (*color)[0], (*color)[1], (*color)[2]));
    if (const auto& intensity = facts.constant.intensity)
        remarks.push_back(
            fmt::format("All points have the same intensity, {}: that is taken for none.", *intensity));
    for (const std::string& note : facts.notes) remarks.push_back(note + ".");
    return remarks;
}

std::string pictureRevision(const CloudFacts& facts) {
    if (!facts.look) return facts.revision;
    const std::string look = printJson(toJson(*facts.look));
    return fmt::format("{}-{:016x}", facts.revision, XXH3_64bits(look.data(), look.size()));
}

Camera Cloud::defaultCamera(double aspect) const {
    Camera camera;
    const double down = std::numbers::pi / 6, turn = std::numbers::pi / 4;
    // From the target to the eye: south is -y, east is +x.
    const double south = std::cos(down) * std::cos(turn), east = std::cos(down) * std::sin(turn);
    const bool yIsUp = standsOnXZ(bounds);
    camera.up = yIsUp ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 back =
        yIsUp ? glm::dvec3(east, std::sin(down), south) : glm::dvec3(east, -south, std::sin(down));
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    const glm::dvec3 up = glm::cross(back, right);
    const double margin = 1.08;
    const double tanUp = std::tan(camera.fov * std::numbers::pi / 360) / margin;
    const double tanRight = tanUp * (aspect > 0 && std::isfinite(aspect) ? aspect : 1.0);

    // Every corner bounds the eye from four sides: in the camera's axes, |corner.x - eye.x| ≤ tan · (eye.z -
    // corner.z). The tightest pair per axis meets where that axis just fills the picture; the farther of the
    // two distances wins.
    const glm::dvec3 middle = (bounds[0] + bounds[1]) * 0.5, half = (bounds[1] - bounds[0]) * 0.5;
    double rightMost = 0, leftMost = 0, topMost = 0, bottomMost = 0, widest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 c = half * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const double x = glm::dot(c, right), y = glm::dot(c, up), z = glm::dot(c, back);
        rightMost = std::max(rightMost, z + x / tanRight);
        leftMost = std::max(leftMost, z - x / tanRight);
        topMost = std::max(topMost, z + y / tanUp);
        bottomMost = std::max(bottomMost, z - y / tanUp);
        widest = std::max({widest, std::abs(y), std::abs(x) * tanUp / tanRight});
    }
    const double offsetRight = tanRight * (rightMost - leftMost) / 2,
                 offsetUp = tanUp * (topMost - bottomMost) / 2;
    const double fitting = std::max(rightMost + leftMost, topMost + bottomMost) / 2;
    // A cloud of one point has no size; it is looked at from a distance at which the eye differs from the
    // target.
    const double distance = std::max({fitting, spacing * 10, glm::length(middle) * 1e-9, 1e-9});
    camera.target = middle + right * offsetRight + up * offsetUp;
    camera.eye = camera.target + back * distance;
    camera.viewHeight = std::max(2 * margin * (widest + std::abs(offsetUp)), distance * 1e-3);
    return camera;
}

}  // namespace scancast
