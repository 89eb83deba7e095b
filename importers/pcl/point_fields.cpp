#include "importers/pcl/point_fields.hpp"

#include <algorithm>
#include <string>

namespace scancast::import_pcl {

namespace {

struct Name {
    std::string_view name;
    Meaning meaning;
};

// The names that PCL, CloudCompare, CGAL, MeshLab, Open3D and PDAL write; compared in lower case.
// Where two of one meaning are in a file, the one further up counts.
constexpr Name names[] = {
    {"x", Meaning::X},
    {"y", Meaning::Y},
    {"z", Meaning::Z},
    {"red", Meaning::Red},
    {"green", Meaning::Green},
    {"blue", Meaning::Blue},
    {"r", Meaning::Red},
    {"g", Meaning::Green},
    {"b", Meaning::Blue},
    {"diffuse_red", Meaning::Red},
    {"diffuse_green", Meaning::Green},
    {"diffuse_blue", Meaning::Blue},
    {"rgb", Meaning::PackedColor},
    {"rgba", Meaning::PackedColor},
    {"intensity", Meaning::Intensity},
    {"scalar_intensity", Meaning::Intensity},
    {"reflectance", Meaning::Intensity},
    {"classification", Meaning::Class},
    {"scalar_classification", Meaning::Class},
    {"label", Meaning::Class},
    {"nx", Meaning::NormalX},
    {"ny", Meaning::NormalY},
    {"nz", Meaning::NormalZ},
    {"normal_x", Meaning::NormalX},
    {"normal_y", Meaning::NormalY},
    {"normal_z", Meaning::NormalZ},
};

const Name* find(std::string_view name) {
    std::string lower(name);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return std::find_if(std::begin(names), std::end(names), [&](auto& n) { return n.name == lower; });
}

}  // namespace

std::optional<Meaning> meaningOf(std::string_view name) {
    const auto* found = find(name);
    if (found == std::end(names)) return std::nullopt;
    return found->meaning;
}

bool isPlainer(std::string_view name, std::string_view other) {
    return find(name) < find(other);
}

Attributes PointFields::attributes() const {
    Attributes result;
    result.color =
        has(Meaning::PackedColor) || (has(Meaning::Red) && has(Meaning::Green) && has(Meaning::Blue));
    result.intensity = has(Meaning::Intensity);
    result.classification = has(Meaning::Class);
    result.normal = has(Meaning::NormalX) && has(Meaning::NormalY) && has(Meaning::NormalZ);
    return result;
}

}  // namespace scancast::import_pcl
