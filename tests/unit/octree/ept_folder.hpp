// A small EPT folder with known points, in memory: written after the published description of the format, from nothing that
// reads it.
#pragma once

#include <zstd.h>

#include <nlohmann/json.hpp>

#include "tests/unit/octree/memory_files.hpp"

namespace scancast::test {

struct EptPoint {
    std::int32_t x, y, z;
    std::uint16_t intensity;
    std::uint8_t classification;
    double time;
    std::array<std::uint16_t, 3> rgb;
};

inline const char* const eptNames[] = {"0-0-0-0", "1-0-0-0", "1-1-0-1", "2-3-1-2", "3-7-2-5"};

/// The i-th point of the n-th node.
inline EptPoint eptPoint(int node, int i, int mostColor = 65535) {
    const std::int32_t k = node * 1000 + i;
    return {k - 500,
            -7 * k,
            k * k - 3,
            static_cast<std::uint16_t>(k * 31),
            static_cast<std::uint8_t>(k % 19),
            1e9 + k / 8.0,
            {static_cast<std::uint16_t>(k * 13 % (mostColor + 1)),
             static_cast<std::uint16_t>(k * 17 % (mostColor + 1)), static_cast<std::uint16_t>(mostColor)}};
}
inline int eptPoints(int node) {
    return 3 + 2 * node;
}
inline constexpr int eptPointsInAll = 35;

inline nlohmann::json eptSchema() {
    return nlohmann::json::parse(R"([
        {"name": "X", "type": "signed", "size": 4, "scale": 0.01, "offset": 1000},
        {"name": "Y", "type": "signed", "size": 4, "scale": 0.02, "offset": -2000},
        {"name": "Z", "type": "signed", "size": 4, "scale": 0.25},
        {"name": "Intensity", "type": "unsigned", "size": 2},
        {"name": "Classification", "type": "unsigned", "size": 1},
        {"name": "GpsTime", "type": "float", "size": 8},
        {"name": "Red", "type": "unsigned", "size": 2},
        {"name": "Green", "type": "unsigned", "size": 2},
        {"name": "Blue", "type": "unsigned", "size": 2}])");
}

inline Bytes eptRecords(int node, int mostColor = 65535) {
    BytesWriter to;
    for (int i = 0; i < eptPoints(node); ++i) {
        const auto p = eptPoint(node, i, mostColor);
        to.add(p.x).add(p.y).add(p.z).add(p.intensity).add(p.classification).add(p.time);
        for (const auto c : p.rgb) to.add(c);
    }
    return to.bytes;
}

inline Bytes zstdOf(const Bytes& bytes) {
    Bytes packed(ZSTD_compressBound(bytes.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
    return packed;
}

/// Its hierarchy in two pages: that of "1-1-0-1" has what lies in there.
inline MemoryFiles eptFolder(const std::string& dataType = "binary", int mostColor = 65535) {
    MemoryFiles files;
    const nlohmann::json ept{
        {"version", "1.0.0"},
        {"dataType", dataType},
        {"hierarchyType", "json"},
        {"points", eptPointsInAll},
        {"span", 128},
        {"bounds", {0, 0, 0, 8, 8, 8}},
        {"boundsConforming", {1, 2, 3, 4, 5, 6}},
        {"schema", eptSchema()},
        {"srs",
         {{"authority", "EPSG"}, {"horizontal", "26912"}, {"wkt", R"(PROJCS["here",UNIT["metre",1]])"}}}};
    files.write("ept.json", ept.dump());
    for (int node = 0; node < 5; ++node) {
        const auto records = eptRecords(node, mostColor);
        const bool packed = dataType == "zstandard";
        files.files[std::string("ept-data/") + eptNames[node] + (packed ? ".zst" : ".bin")] =
            packed ? zstdOf(records) : records;
    }
    files.write("ept-hierarchy/0-0-0-0.json", R"({"0-0-0-0": 3, "1-0-0-0": 5, "1-1-0-1": -1, "1-0-1-0": 0})");
    files.write("ept-hierarchy/1-1-0-1.json", R"({"1-1-0-1": 7, "2-3-1-2": 9, "3-7-2-5": 11})");
    return files;
}

/// Changes a JSON file.
template <class Change>
void changeJson(MemoryFiles& files, const std::string& name, Change change) {
    auto& bytes = files.files[name];
    auto json = nlohmann::json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    change(json);
    files.write(name, json.dump());
}

}  // namespace scancast::test
