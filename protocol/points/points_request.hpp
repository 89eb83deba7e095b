// What a client asks for points: the bodies of POST /clouds/{id}/points and POST /clouds/{id}/profile. Plain values and their
// JSON. Pure functions; any thread. Pipeline: JSON → **request** → region, corridor → writers.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "protocol/points/points_region.hpp"

namespace scancast {

enum class PointsFormat : std::uint8_t { Las, Ply, Csv, Text };
inline constexpr std::array<std::string_view, 4> pointsFormatNames{"las", "ply", "csv", "txt"};
constexpr std::string_view name(PointsFormat format) {
    return pointsFormatNames[std::size_t(format)];
}
/// Nothing where there is none of that name.
std::optional<PointsFormat> pointsFormatOf(std::string_view name);
/// "text/csv; charset=utf-8"
std::string_view mediaType(PointsFormat format);

struct PointsRequest {
    PointsFormat format = PointsFormat::Las;
    PointsRegion region{};
    bool estimatedNormals = false;  ///< those too that ingest estimated (`normals`)
};

/// How a profile is drawn: station to the right, height upwards.
struct ProfilePicture {
    int width = 1600;  ///< px
    /// px; nullopt: what the heights take at this scale.
    std::optional<int> height{};
    /// Heights are drawn so many times as large as stations; nullopt: 1, or what fills `height`.
    std::optional<double> exaggeration{};
    /// px, side of a point's square; nullopt: 1, or as far as points lie apart (renderer/profile/grow_dots.hpp).
    std::optional<int> pointSize{};
    /// Of the view's words, those of colours: color, exposure, colormap, range, background.
    Style style{};
};
inline constexpr int mostProfileSide = 16384;
inline constexpr int mostProfilePointSize = 64;

inline constexpr std::size_t mostLineCorners = 1000;

struct ProfileRequest {
    std::vector<glm::dvec2> line;  ///< 2 to mostLineCorners, in plan
    double width = 1;              ///< of the corridor, across: half of it on either side
    PointsRegion region{};
    std::optional<PointsFormat> format = PointsFormat::Csv;  ///< nullopt: a picture, PNG
    bool estimatedNormals = false;
    ProfilePicture picture{};
};

/// Whether a corridor can be made of it: enough corners, none the same as the one before, a width above 0. InvalidArgument.
Expected<void> checkLine(const std::vector<glm::dvec2>& line, double width);

/// Malformed when the text is no JSON; InvalidArgument, with the path as field, for everything else.
Expected<PointsRequest> parsePointsRequest(std::string_view text);
/// `picture`: where the body names no format, a picture is meant.
Expected<ProfileRequest> parseProfileRequest(std::string_view text, bool picture = false);
nlohmann::json toJson(const PointsRequest& request);
nlohmann::json toJson(const ProfileRequest& request);

}  // namespace scancast
