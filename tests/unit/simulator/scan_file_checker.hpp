// Reads back what the writers wrote: as little of PLY and LAS as they use, straight from the specifications
// and independent of the readers.
#pragma once

#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "renderer/cloud/point_batch.hpp"

namespace scancast::test {

struct ScanFile {
    std::vector<std::string> properties;  ///< PLY: "float x"
    std::uint64_t declared = 0;
    std::array<glm::dvec3, 2> bounds{};
    glm::dvec3 step{0};
    int minor = 0, format = 0;
    std::string problem;  ///< empty = sound
    PointBatch points;
};

template <class Number>
Number numberAt(const std::string& bytes, std::size_t at) {
    Number value{};
    if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

inline ScanFile parseLas(const std::string& bytes) {
    ScanFile file;
    if (bytes.size() < 227 || bytes.compare(0, 4, "LASF") != 0) return file.problem = "no LAS", file;
    file.minor = numberAt<std::uint8_t>(bytes, 25);
    file.format = numberAt<std::uint8_t>(bytes, 104);
    const auto headerSize = numberAt<std::uint16_t>(bytes, 94), record = numberAt<std::uint16_t>(bytes, 105);
    const auto start = numberAt<std::uint32_t>(bytes, 96);
    file.declared =
        file.minor >= 4 ? numberAt<std::uint64_t>(bytes, 247) : numberAt<std::uint32_t>(bytes, 107);
    if (headerSize != (file.minor >= 4 ? 375 : 227) || start != headerSize) file.problem = "header size";
    if (bytes.size() != start + file.declared * record) file.problem = "file size";
    if (!file.problem.empty()) return file;
    glm::dvec3 offset;
    for (int axis = 0; axis < 3; ++axis) {
        file.step[axis] = numberAt<double>(bytes, 131 + std::size_t(axis) * 8);
        offset[axis] = numberAt<double>(bytes, 155 + std::size_t(axis) * 8);
        file.bounds[1][axis] = numberAt<double>(bytes, 179 + std::size_t(axis) * 16);
        file.bounds[0][axis] = numberAt<double>(bytes, 187 + std::size_t(axis) * 16);
    }
    const std::size_t classAt = file.minor >= 4 ? 16 : 15, colorAt = file.minor >= 4 ? 30 : 20;
    for (std::size_t at = start; at < bytes.size(); at += record) {
        glm::dvec3 position;
        for (int axis = 0; axis < 3; ++axis)
            position[axis] =
                offset[axis] + numberAt<std::int32_t>(bytes, at + std::size_t(axis) * 4) * file.step[axis];
        file.points.position.push_back(position);
        file.points.intensity.push_back(numberAt<std::uint16_t>(bytes, at + 12));
        file.points.classification.push_back(numberAt<std::uint8_t>(bytes, at + classAt));
        std::array<std::uint8_t, 3> color;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto wide = numberAt<std::uint16_t>(bytes, at + colorAt + 2 * c);
            if (wide % 257 != 0) file.problem = "colour is not 8 bits stretched to 16";
            color[c] = std::uint8_t(wide / 257);
        }
        file.points.color.push_back(color);
    }
    return file;
}

inline ScanFile parsePly(const std::string& bytes) {
    ScanFile file;
    const std::size_t end = bytes.find("end_header\n");
    if (bytes.compare(0, 4, "ply\n") != 0 || end == std::string::npos) return file.problem = "no PLY", file;
    std::istringstream header(bytes.substr(0, end));
    for (std::string line; std::getline(header, line);) {
        if (line.rfind("element vertex ", 0) == 0) file.declared = std::stoull(line.substr(15));
        if (line.rfind("property ", 0) == 0) file.properties.push_back(line.substr(9));
    }
    const bool wide = !file.properties.empty() && file.properties[0] == "double x";
    const std::size_t record = (wide ? 24 : 12) + 12 + 3 + 1 + 2, start = end + 11;
    if (bytes.size() != start + file.declared * record) return file.problem = "file size", file;
    for (std::size_t at = start; at < bytes.size(); at += record) {
        glm::dvec3 position;
        glm::vec3 normal;
        for (int axis = 0; axis < 3; ++axis) {
            const auto slot = std::size_t(axis);
            position[axis] =
                wide ? numberAt<double>(bytes, at + slot * 8) : double(numberAt<float>(bytes, at + slot * 4));
            normal[axis] = numberAt<float>(bytes, at + (wide ? 24 : 12) + slot * 4);
        }
        const std::size_t rest = at + (wide ? 36 : 24);
        file.points.position.push_back(position);
        file.points.normal.push_back(normal);
        file.points.color.push_back(numberAt<std::array<std::uint8_t, 3>>(bytes, rest));
        file.points.classification.push_back(numberAt<std::uint8_t>(bytes, rest + 3));
        file.points.intensity.push_back(numberAt<std::uint16_t>(bytes, rest + 4));
    }
    return file;
}

}  // namespace scancast::test
