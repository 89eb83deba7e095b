// Small Potree octrees with known points, in memory: written after the published descriptions of the formats, from nothing
// that reads them. Morton codes are made bit by bit.
#pragma once

#include <brotli/encode.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/unit/octree/memory_files.hpp"

namespace scancast::test {

struct PotreePoint {
    std::array<std::int32_t, 3> xyz;
    std::uint16_t intensity;
    std::uint8_t classification;
    double time;
    std::array<std::uint16_t, 3> rgb;
    std::array<float, 3> normal;
};

inline const std::vector<std::string> potreeNames{"r", "r0", "r7", "r03", "r031", "r0312", "r75"};
inline int potreePoints(std::size_t node) {
    return static_cast<int>(node) + 1;
}
inline constexpr int potreePointsInAll = 28;

/// The i-th point of the n-th node, all over the range of 32 bits.
inline PotreePoint potreePoint(std::size_t node, int i, int mostColor = 65535) {
    const auto k = static_cast<std::int32_t>(node) * 100 + i;
    return {{k * 3'000'001, -k * 7, k % 2 == 0 ? 2'147'483'647 - k : -2'147'483'647 + k},
            static_cast<std::uint16_t>(k * 131),
            static_cast<std::uint8_t>(k % 23),
            k / 7.0,
            {static_cast<std::uint16_t>(k * 11 % (mostColor + 1)), static_cast<std::uint16_t>(mostColor),
             static_cast<std::uint16_t>(k % (mostColor + 1))},
            {0.6F, k % 2 == 0 ? 0.8F : -0.8F, 0}};
}

/// Bit i of number k becomes bit 3i + k.
inline std::uint64_t interleaved(std::array<std::uint32_t, 3> numbers) {
    std::uint64_t code = 0;
    for (unsigned i = 0; i < 16; ++i)
        for (unsigned k = 0; k < 3; ++k)
            if ((numbers[k] >> i & 1U) != 0) code |= std::uint64_t(1) << (3 * i + k);
    return code;
}

inline nlohmann::json potreeAttributes() {
    return nlohmann::json::parse(R"([
        {"name": "position", "size": 12, "numElements": 3, "elementSize": 4, "type": "int32"},
        {"name": "intensity", "size": 2, "numElements": 1, "elementSize": 2, "type": "uint16"},
        {"name": "classification", "size": 1, "numElements": 1, "elementSize": 1, "type": "uint8"},
        {"name": "gps-time", "size": 8, "numElements": 1, "elementSize": 8, "type": "double"},
        {"name": "rgb", "size": 6, "numElements": 3, "elementSize": 2, "type": "uint16"},
        {"name": "NormalX", "size": 4, "numElements": 1, "elementSize": 4, "type": "float"},
        {"name": "NormalY", "size": 4, "numElements": 1, "elementSize": 4, "type": "float"},
        {"name": "NormalZ", "size": 4, "numElements": 1, "elementSize": 4, "type": "float"}])");
}

/// One attribute of a point, as it is in a record.
inline void addAttribute(BytesWriter& to, std::size_t attribute, const PotreePoint& p) {
    switch (attribute) {
        case 0:
            for (const auto v : p.xyz) to.add(v);
            return;
        case 1:
            to.add(p.intensity);
            return;
        case 2:
            to.add(p.classification);
            return;
        case 3:
            to.add(p.time);
            return;
        case 4:
            for (const auto v : p.rgb) to.add(v);
            return;
        default:
            to.add(p.normal[attribute - 5]);
    }
}

inline Bytes brotliOf(const Bytes& bytes) {
    std::size_t size = BrotliEncoderMaxCompressedSize(bytes.size());
    Bytes packed(size);
    BrotliEncoderCompress(4, 22, BROTLI_MODE_GENERIC, bytes.size(),
                          reinterpret_cast<const std::uint8_t*>(bytes.data()), &size,
                          reinterpret_cast<std::uint8_t*>(packed.data()));
    packed.resize(size);
    return packed;
}

inline Bytes potreeNode(std::size_t node, bool isBrotli, int mostColor) {
    BytesWriter to;
    const int count = potreePoints(node);
    if (!isBrotli) {
        for (int i = 0; i < count; ++i)
            for (std::size_t attribute = 0; attribute < 8; ++attribute)
                addAttribute(to, attribute, potreePoint(node, i, mostColor));
        return to.bytes;
    }
    for (std::size_t attribute = 0; attribute < 8; ++attribute)
        for (int i = 0; i < count; ++i) {
            const auto p = potreePoint(node, i, mostColor);
            std::array<std::uint32_t, 3> low{}, high{};
            for (std::size_t k = 0; k < 3; ++k) {
                low[k] = static_cast<std::uint32_t>(p.xyz[k]) & 0xffff;
                high[k] = static_cast<std::uint32_t>(p.xyz[k]) >> 16;
            }
            if (attribute == 0)
                to.add(interleaved(high)).add(interleaved(low));
            else if (attribute == 4)
                to.add(interleaved({p.rgb[0], p.rgb[1], p.rgb[2]}));
            else
                addAttribute(to, attribute, p);
        }
    return brotliOf(to.bytes);
}

inline std::uint8_t childMask(const std::string& name) {
    unsigned mask = 0;
    for (const auto& other : potreeNames)
        if (other.size() == name.size() + 1 && other.starts_with(name)) mask |= 1U << (other.back() - '0');
    return static_cast<std::uint8_t>(mask);
}

/// `root` and what lies below it, level after level, as far as `goesOn` says.
inline std::vector<std::string> levelsBelow(const std::string& root,
                                            const std::function<bool(const std::string&)>& goesOn) {
    std::vector<std::string> order{root};
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (order[i] != root && !goesOn(order[i])) continue;
        const std::string above = order[i];
        for (const auto& name : potreeNames)
            if (name.size() == above.size() + 1 && name.starts_with(above)) order.push_back(name);
    }
    return order;
}

/// "r03" and "r0312" begin a chunk of the hierarchy of their own.
inline MemoryFiles potree2Folder(const std::string& encoding = "DEFAULT", int mostColor = 65535) {
    MemoryFiles files;
    BytesWriter octree;
    std::map<std::string, std::array<std::uint64_t, 3>> places;  // at, bytes, points
    for (std::size_t node = 0; node < potreeNames.size(); ++node) {
        const auto bytes = potreeNode(node, encoding == "BROTLI", mostColor);
        places[potreeNames[node]] = {octree.bytes.size(), bytes.size(), std::uint64_t(potreePoints(node))};
        octree.add(bytes);
    }
    files.files["octree.bin"] = octree.bytes;
    const std::set<std::string> own{"r03", "r0312"};
    std::map<std::string, std::array<std::uint64_t, 3>> chunks;
    std::vector<std::vector<std::string>> orders;
    std::uint64_t at = 0;
    for (const std::string root : {"r", "r03", "r0312"}) {
        orders.push_back(levelsBelow(root, [&](const std::string& name) { return !own.contains(name); }));
        chunks[root] = {at, 22 * orders.back().size(), places[root][2]};
        at += 22 * orders.back().size();
    }
    BytesWriter hierarchy;
    for (const auto& order : orders)
        for (std::size_t i = 0; i < order.size(); ++i) {
            const bool proxy = i > 0 && own.contains(order[i]);
            const auto& place = proxy ? chunks[order[i]] : places[order[i]];
            hierarchy.add(std::uint8_t(proxy                      ? 2
                                       : childMask(order[i]) != 0 ? 0
                                                                  : 1))
                .add(childMask(order[i]));
            hierarchy.add(std::uint32_t(place[2])).add(place[0]).add(place[1]);
        }
    files.files["hierarchy.bin"] = hierarchy.bytes;
    const nlohmann::json metadata{
        {"version", "2.0"},
        {"points", potreePointsInAll},
        {"projection", "EPSG:25832"},
        {"hierarchy", {{"firstChunkSize", chunks["r"][1]}, {"stepSize", 4}, {"depth", 3}}},
        {"offset", {1000, -2000, 0.5}},
        {"scale", {0.001, 0.002, 0.25}},
        {"boundingBox", {{"min", {0, 0, 0}}, {"max", {1, 1, 1}}}},
        {"encoding", encoding},
        {"attributes", potreeAttributes()}};
    files.write("metadata.json", metadata.dump());
    return files;
}

/// How a Potree 1 octree is written.
struct Potree1 {
    std::string normal = "NORMAL_OCT16";
    std::size_t step = 2;
    std::function<std::uint32_t(const std::string&, std::uint32_t)> counted =
        [](const std::string&, std::uint32_t n) { return n; };
    /// Whether the .hrc file of `root` knows that `name` has children.
    std::function<bool(const std::string& root, const std::string& name)> masked = [](auto&, auto&) {
        return true;
    };
};

inline std::string potreePath(const std::string& name, std::size_t step) {
    std::string path = "data/r/";
    for (std::size_t at = 1; at + step <= name.size(); at += step) path += name.substr(at, step) + "/";
    return path + name;
}

/// Of "r", straight up; of any other, along x.
inline void addNormal(BytesWriter& to, const std::string& kind, bool up) {
    if (kind == "NORMAL") {
        to.add(up ? 0.0F : 2.0F).add(0.0F).add(up ? 2.0F : 0.0F);
    } else if (kind == "NORMAL_OCT16") {
        to.add(std::uint8_t(up ? 128 : 255)).add(std::uint8_t(128));
    } else {  // the mirror ball: its middle is up, and half of its radius squared is level
        to.add(std::uint8_t(up ? 128 : 218)).add(std::uint8_t(128));
    }
}

inline Bytes potree1Node(std::size_t node, const Potree1& how) {
    BytesWriter to;
    for (int i = 0; i < potreePoints(node); ++i) {
        to.add(std::int32_t(100 * i - 20)).add(std::int32_t(i)).add(std::int32_t(-3 * i));
        to.add(std::uint8_t(node)).add(std::uint8_t(i)).add(std::uint8_t(200)).add(std::uint8_t(9));
        to.add(std::uint16_t(60000 + i)).add(std::uint8_t(i + 1)).add(std::uint8_t(5));
        addNormal(to, how.normal, node == 0);
    }
    return to.bytes;
}

inline MemoryFiles potree1Folder(const Potree1& how = {}) {
    MemoryFiles files;
    for (std::size_t node = 0; node < potreeNames.size(); ++node)
        files.files[potreePath(potreeNames[node], how.step) + ".bin"] = potree1Node(node, how);
    for (const auto& root : potreeNames) {
        if ((root.size() - 1) % how.step != 0 || (root != "r" && childMask(root) == 0)) continue;
        BytesWriter hrc;
        for (const auto& name : levelsBelow(
                 root, [&](const std::string& below) { return below.size() - root.size() < how.step; })) {
            const auto node = static_cast<std::size_t>(
                std::find(potreeNames.begin(), potreeNames.end(), name) - potreeNames.begin());
            hrc.add(how.masked(root, name) ? childMask(name) : std::uint8_t(0));
            hrc.add(how.counted(name, static_cast<std::uint32_t>(potreePoints(node))));
        }
        files.files[potreePath(root, how.step) + ".hrc"] = hrc.bytes;
    }
    const nlohmann::json cloud{
        {"version", "1.7"},
        {"octreeDir", "data"},
        {"boundingBox", {{"lx", 10}, {"ly", 20}, {"lz", 30}, {"ux", 18}, {"uy", 28}, {"uz", 38}}},
        {"pointAttributes",
         {"POSITION_CARTESIAN", "RGBA_PACKED", "INTENSITY", "CLASSIFICATION", "RETURN_NUMBER", how.normal}},
        {"spacing", 0.1},
        {"scale", 0.01},
        {"hierarchyStepSize", how.step}};
    files.write("cloud.js", cloud.dump());
    return files;
}

}  // namespace scancast::test
