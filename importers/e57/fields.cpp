#include "importers/e57/fields.hpp"

namespace scancast::import_e57 {

namespace {

using namespace std::string_view_literals;

struct Named {
    std::string_view name;
    Role role;
};

constexpr Named core[] = {
    {"cartesianX"sv, Role::X},
    {"cartesianY"sv, Role::Y},
    {"cartesianZ"sv, Role::Z},
    {"cartesianInvalidState"sv, Role::CartesianState},
    {"sphericalRange"sv, Role::Range},
    {"sphericalAzimuth"sv, Role::Azimuth},
    {"sphericalElevation"sv, Role::Elevation},
    {"sphericalInvalidState"sv, Role::SphericalState},
    {"colorRed"sv, Role::Red},
    {"colorGreen"sv, Role::Green},
    {"colorBlue"sv, Role::Blue},
    {"isColorInvalid"sv, Role::ColorInvalid},
    {"intensity"sv, Role::Intensity},
    {"isIntensityInvalid"sv, Role::IntensityInvalid},
    {"rowIndex"sv, Role::Row},
    {"columnIndex"sv, Role::Column},
    {"returnIndex"sv, Role::ReturnIndex},
    {"returnCount"sv, Role::ReturnCount},
    {"timeStamp"sv, Role::Time},
    {"isTimeStampInvalid"sv, Role::TimeInvalid},
};

// Of extensions, whatever they call their prefix: surface normals (libE57) and LAS in E57.
constexpr Named extensions[] = {
    {"normalX"sv, Role::NormalX},
    {"normalY"sv, Role::NormalY},
    {"normalZ"sv, Role::NormalZ},
    {"classification"sv, Role::Class},
};

}  // namespace

std::optional<Role> roleOf(std::string_view fieldName) {
    for (const auto& [name, role] : core)
        if (fieldName == name) return role;
    const auto colon = fieldName.find(':');
    const auto local = colon == std::string_view::npos ? fieldName : fieldName.substr(colon + 1);
    for (const auto& [name, role] : extensions)
        if (local == name) return role;
    return std::nullopt;
}

}  // namespace scancast::import_e57
