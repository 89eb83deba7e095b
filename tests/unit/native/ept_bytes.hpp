// Sets of EPT made here, in memory: the same points in the same voxels as a COPC file (copc_bytes.hpp), in every kind of tile. Tiles of LAZ
// are LAS here, whose records are as they are: that LAZ gives the same is proved where it is decoded.
#pragma once

#include <zstd.h>

#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "files/folder_reader.hpp"
#include "importers/octree/ept/tile_chunk.hpp"
#include "renderer/cloud/native/ept/ept_cloud.hpp"
#include "tests/unit/native/copc_bytes.hpp"

namespace scancast::test {

/// Files in memory, that say which were asked for.
class MemoryFolder final : public FolderReader {
  public:
    std::map<std::string, Bytes> files;
    mutable std::multiset<std::string> asked;
    bool isFar = false;                           ///< what is read may be another the second time
    mutable std::map<std::string, Bytes> atHand;  ///< what is read instead until it is forgotten

    void write(const std::string& name, std::string_view text) {
        const auto bytes = std::as_bytes(std::span(text));
        files[name].assign(bytes.begin(), bytes.end());
    }
    Expected<Bytes> read(const std::string& name, std::uint64_t most) const override {
        const std::lock_guard lock(*mutex_);  // threads read upper voxels beside each other
        asked.insert(name);
        if (const auto other = atHand.find(name); other != atHand.end()) return other->second;
        const auto found = files.find(name);
        if (found == files.end()) return fail(ErrorCode::NotFound, "its file " + name + " is missing");
        if (found->second.size() > most)
            return fail(ErrorCode::ResourceLimit, "its file " + name + " is too long");
        return found->second;
    }
    bool forget(const std::string& name) const override {
        const std::lock_guard lock(*mutex_);
        atHand.erase(name);
        return isFar;
    }

  private:
    std::shared_ptr<std::mutex> mutex_ = std::make_shared<std::mutex>();  // folders are copied and moved
};

/// The importer's code, in this process.
class TileDecoders final : public ChunkDecoders {
  public:
    Expected<Bytes> decode(const ChunkShape& shape, std::uint64_t points,
                           std::span<const std::byte> chunk) override {
        return import_octree::decodeTile(
            {shape.packing, shape.pointFormat, shape.recordBytes, 0, points, chunk.size()}, {}, chunk);
    }
};

class EptMaker {
  public:
    enum class Kind : std::uint8_t { Laszip, Binary, Zstandard, Floats };
    static constexpr std::array kinds{Kind::Laszip, Kind::Binary, Kind::Zstandard, Kind::Floats};

    static const char* dataType(Kind kind) {
        return kind == Kind::Laszip ? "laszip" : kind == Kind::Zstandard ? "zstandard" : "binary";
    }
    static std::string tileName(const VoxelKey& key, Kind kind) {
        const char* ending = kind == Kind::Laszip ? "laz" : kind == Kind::Zstandard ? "zst" : "bin";
        return "ept-data/" + text(key) + "." + ending;
    }

    /// Pages begin at the root and at each voxel of level 2.
    static MemoryFolder make(const CopcBytes& copc, Kind kind) {
        MemoryFolder folder;
        std::map<VoxelKey, nlohmann::json> pages;
        for (const auto& [key, own] : copc.voxels) {
            VoxelKey root = key;
            while (root.level > 2) root = root.parent();
            if (root.level < 2) root = {};
            if (key.level == 2) pages[{}][text(key)] = -1;
            pages[root][text(key)] = own.size();
            if (!own.empty()) folder.files[tileName(key, kind)] = tile(copc, own, kind);
        }
        for (const auto& [root, page] : pages)
            folder.write("ept-hierarchy/" + text(root) + ".json", page.dump());
        folder.write("ept.json", description(copc, kind).dump());
        return folder;
    }

    static nlohmann::json description(const CopcBytes& copc, Kind kind) {
        nlohmann::json schema = nlohmann::json::array();
        const double offsets[3] = {1000, 2000, 0};
        for (int a = 0; a < 3; ++a) {
            nlohmann::json axis{{"name", std::string(1, char('X' + a))}, {"type", "signed"}, {"size", 4}};
            axis["scale"] = copcScale, axis["offset"] = offsets[a];
            if (kind == Kind::Floats)
                axis = {{"name", std::string(1, char('X' + a))}, {"type", "float"}, {"size", 8}};
            schema.push_back(axis);
        }
        for (const char* name : {"Intensity", "Red", "Green", "Blue"})
            schema.push_back({{"name", name}, {"type", "unsigned"}, {"size", 2}});
        schema.push_back({{"name", "Classification"}, {"type", "unsigned"}, {"size", 1}});
        const auto bound = [&](std::size_t at) { return loadLe<double>(copc.file.data() + at); };
        return {
            {"version", "1.1.0"},
            {"dataType", dataType(kind)},
            {"hierarchyType", "json"},
            {"points", copc.points.size()},
            {"bounds", {1000, 2000, 0, 1064, 2064, 64}},
            {"boundsConforming", {bound(187), bound(203), bound(219), bound(179), bound(195), bound(211)}},
            {"schema", schema}};
    }

  private:
    static Bytes tile(const CopcBytes& copc, const std::vector<CopcPoint>& points, Kind kind) {
        if (kind == Kind::Laszip) {
            Bytes las(copc.file.begin(), copc.file.begin() + 375);
            storeLe(las.data() + 96, std::uint32_t(375));
            storeLe(las.data() + 100, std::uint32_t(0));
            las[104] = std::byte{7};
            storeLe(las.data() + 247, std::uint64_t(points.size()));
            las.resize(375 + points.size() * copcRecordBytes);
            for (std::size_t i = 0; i < points.size(); ++i)
                putRecord(points[i], las.data() + 375 + i * copcRecordBytes);
            return las;
        }
        Bytes records;
        const auto add = [&](auto value) {
            records.resize(records.size() + sizeof value);
            storeLe(records.data() + records.size() - sizeof value, value);
        };
        for (const CopcPoint& p : points) {
            if (kind == Kind::Floats) {
                add(1000 + copcScale * p.x), add(2000 + copcScale * p.y), add(copcScale * p.z);
            } else {
                add(p.x), add(p.y), add(p.z);
            }
            add(p.intensity), add(p.red), add(p.green), add(p.blue), add(p.classification);
        }
        if (kind != Kind::Zstandard) return records;
        Bytes packed(ZSTD_compressBound(records.size()));
        packed.resize(ZSTD_compress(packed.data(), packed.size(), records.data(), records.size(), 3));
        return packed;
    }
};

}  // namespace scancast::test
