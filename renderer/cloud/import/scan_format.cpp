#include "renderer/cloud/import/scan_format.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "renderer/cloud/import/foreign/foreign_formats.hpp"
#include "renderer/cloud/import/text/obj_source.hpp"
#include "renderer/cloud/import/text/text_head.hpp"

namespace scancast {

namespace {

bool isText(std::string_view start) {
    return std::all_of(start.begin(), start.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte >= 0x20 ? byte != 0x7f : (c == '\n' || c == '\r' || c == '\t');
    });
}

std::string_view firstWord(std::string_view line) {
    const auto begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    return line.substr(begin, line.find_first_of(" \t", begin) - begin);
}

/// PCD: lines of "KEYWORD values", perhaps after comments. VERSION or FIELDS comes first; old files say
/// COLUMNS.
bool isPcd(std::string_view start) {
    while (!start.empty()) {
        const auto end = start.find_first_of("\r\n");
        const auto line = start.substr(0, end);
        if (line.starts_with("# .PCD")) return true;
        const auto word = firstWord(line);
        if (word == "VERSION" || word == "FIELDS" || word == "COLUMNS") return true;
        if (!word.empty() && !word.starts_with('#')) return false;
        if (end == std::string_view::npos) return false;
        start.remove_prefix(end + 1);
    }
    return false;
}

/// "ply", perhaps trailing blanks, end of line.
bool isPly(std::string_view start) {
    if (!start.starts_with("ply")) return false;
    const auto end = start.find_first_not_of(" \t", 3);
    return end != std::string_view::npos && (start[end] == '\n' || start[end] == '\r');
}

Identified identifyText(std::string_view start, std::string_view extension) {
    if (extension == ".pcd")
        return {ScanFormat::Unknown,
                "it is text without a PCD header (lines such as \"FIELDS x y z\" are missing)"};
    if (extension == ".ply")
        return {ScanFormat::Unknown, "it is text without a PLY header (the first line is not \"ply\")"};
    if (looksLikeObj(start, extension == ".obj")) return {ScanFormat::Obj, {}};
    if (looksLikePtx(start)) return {ScanFormat::Ptx, {}};
    if (looksLikePoints(start)) return {extension == ".ptx" ? ScanFormat::Ptx : ScanFormat::Text, {}};
    if (const auto* foreign = foreignByName(extension)) return {ScanFormat::Unknown, sentence(*foreign)};
    return {ScanFormat::Unknown,
            "it is text, but not of points (most of its first lines have no three numbers)"};
}

/// LASzip marks a compressed file by the two highest bits of the point format.
bool isLaz(std::string_view start) {
    constexpr std::size_t atPointFormat = 104;
    return start.size() > atPointFormat && (static_cast<unsigned char>(start[atPointFormat]) & 0xc0) != 0;
}

std::string firstBytes(std::string_view start) {
    std::string text = "its content is not that of a point cloud (it starts with the bytes";
    for (const char c : start.substr(0, 4)) {
        std::array<char, 4> hex{};
        std::snprintf(hex.data(), hex.size(), " %02x", static_cast<unsigned>(static_cast<unsigned char>(c)));
        text += hex.data();
    }
    return text + ")";
}

}  // namespace

std::string_view readableFormats() {
    return "Scancast reads LAS and LAZ 1.0-1.4 (COPC included), E57, PLY (ascii and binary), PCD (ascii, "
           "binary "
           "and binary_compressed), text (XYZ, TXT, CSV, PTS, PTX), vertices of OBJ and octrees of EPT and "
           "Potree "
           "(folders)";
}

Identified identifyScan(std::span<const std::byte> bytes, std::string_view extension) {
    const std::string_view start(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (start.starts_with("LASF")) return {isLaz(start) ? ScanFormat::Laz : ScanFormat::Las, {}};
    if (isPly(start)) return {ScanFormat::Ply, {}};
    if (start.starts_with("ASTM-E57")) return {ScanFormat::E57, {}};
    if (const auto* foreign = foreignByContent(start, extension))
        return {ScanFormat::Unknown, sentence(*foreign)};
    if (isPcd(start)) return {ScanFormat::Pcd, {}};
    if (isText(start)) return identifyText(start, extension);
    if (const auto* foreign = foreignByName(extension)) return {ScanFormat::Unknown, sentence(*foreign)};
    return {ScanFormat::Unknown, firstBytes(start)};
}

}  // namespace scancast
