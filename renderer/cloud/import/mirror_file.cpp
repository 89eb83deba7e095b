#include "renderer/cloud/import/mirror_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"
#include "protocol/view/view_values.hpp"

namespace scancast {

namespace {

using nlohmann::json;

// 64 mirrors need 20 kB.
constexpr std::size_t longestFile = std::size_t(1) << 20;
// Coordinates beyond are damage; so are mirrors of that size.
constexpr double farthest = 1e15;
// Sine of the least angle between normal and up: below, up says nothing.
constexpr double leastSine = 1e-6;

bool within(const glm::dvec3& v) {
    return std::abs(v.x) <= farthest && std::abs(v.y) <= farthest && std::abs(v.z) <= farthest;
}

void readVector(FieldReader& fields, const char* key, glm::dvec3& out) {
    if (fields.require(key) == nullptr || !fields.vector(key, out)) return;
    if (!within(out)) fields.error(key, "its numbers must lie within -1e15 and 1e15");
}

/// Unit length.
void readDirection(FieldReader& fields, const char* key, glm::dvec3& out) {
    readVector(fields, key, out);
    if (fields.failed()) return;
    const double length = glm::length(out);
    if (!(length > 1e-12)) return fields.error(key, "must not be zero; it is a direction");
    out /= length;
}

void readSize(FieldReader& fields, const char* key, double& out) {
    if (fields.require(key) == nullptr || !fields.number(key, out)) return;
    if (!(out > 0 && out <= farthest)) fields.error(key, "must be greater than 0");
}

void readTint(FieldReader& fields, Rgb8& out) {
    std::string text;
    if (!fields.text("tint", text)) return;
    const auto color = values::parse<Rgb8>(text);
    if (!color || !text.starts_with('#'))
        return fields.error("tint", "expected a colour as \"#rrggbb\", for example \"#ecf3f0\"");
    out = *color;
}

void readMirror(FieldReader& fields, Mirror& mirror) {
    readVector(fields, "center", mirror.center);
    readDirection(fields, "normal", mirror.normal);
    readDirection(fields, "up", mirror.up);
    readSize(fields, "width", mirror.width);
    readSize(fields, "height", mirror.height);
    readTint(fields, mirror.tint);
    if (fields.failed()) return;
    const auto across = mirror.up - glm::dot(mirror.up, mirror.normal) * mirror.normal;
    const double sine = glm::length(across);
    if (!(sine > leastSine)) return fields.error("up", "must not be parallel to normal");
    mirror.up = across / sine;
}

}  // namespace

Expected<std::vector<Mirror>> parseMirrors(std::string_view text, const std::string& name) {
    const auto failed = [&](const Error& error) {
        return fail(ErrorCode::Malformed, name + ": " + error.message, error.field);
    };
    const auto document = parseJson(text);
    if (!document) return failed(document.error());
    FieldReader fields(*document, {}, ErrorCode::Malformed);
    std::vector<Mirror> mirrors;
    if (const auto* list = fields.require("mirrors")) {
        if (!list->is_array()) {
            fields.error("mirrors", "expected an array of mirrors");
        } else if (list->size() > mostMirrors) {
            fields.error("mirrors", fmt::format("there are {} mirrors; at most {} are allowed", list->size(),
                                                mostMirrors));
        } else {
            for (std::size_t i = 0; i < list->size() && !fields.failed(); ++i) {
                FieldReader entry((*list)[i], fmt::format("mirrors[{}]", i), ErrorCode::Malformed);
                readMirror(entry, mirrors.emplace_back());
                if (const auto sound = entry.finishStrict(); !sound) fields.error(sound.error());
            }
        }
    }
    if (const auto sound = fields.finishStrict(); !sound) return failed(sound.error());
    return mirrors;
}

Expected<std::vector<Mirror>> readMirrors(const InputFile& file) {
    const auto name = file.name().string();
    const auto text = file.text(longestFile);
    if (!text && text.error().code == ErrorCode::ResourceLimit)
        return fail(ErrorCode::Malformed, name + " is longer than 1 MiB; mirrors need a few kilobytes");
    if (!text) return passOn(text);
    return parseMirrors(*text, name);
}

Expected<std::vector<Mirror>> readMirrors(const std::filesystem::path& path) {
    const auto file = InputFile::open(path);
    if (!file) return passOn(file);
    return readMirrors(*file);
}

std::filesystem::path mirrorsFileOf(const std::filesystem::path& scan) {
    auto file = scan;
    file += ".mirrors.json";
    return file;
}

Expected<std::vector<Mirror>> mirrorsBeside(const std::filesystem::path& scan) {
    auto mirrors = readMirrors(mirrorsFileOf(scan));
    if (!mirrors && mirrors.error().code == ErrorCode::NotFound) return std::vector<Mirror>();
    return mirrors;
}

std::string printMirrors(const std::vector<Mirror>& mirrors) {
    const auto vector = [](const glm::dvec3& v) { return json{v.x, v.y, v.z}; };
    auto list = json::array();
    for (const Mirror& mirror : mirrors) {
        list.push_back({{"center", vector(mirror.center)},
                        {"normal", vector(mirror.normal)},
                        {"up", vector(mirror.up)},
                        {"width", mirror.width},
                        {"height", mirror.height},
                        {"tint", values::print(mirror.tint)}});
    }
    return json{{"mirrors", list}}.dump(2) + "\n";
}

}  // namespace scancast
