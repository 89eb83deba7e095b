// An octree's folder in memory, and what its importer sends of it. For tests and fuzzers.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "importers/octree/octree_import.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"

namespace scancast::test {

using Bytes = std::vector<std::byte>;

inline Bytes bytesOfText(std::string_view text) {
    const auto* data = reinterpret_cast<const std::byte*>(text.data());
    return {data, data + text.size()};
}

/// Numbers one behind the other, little-endian.
class BytesWriter {
  public:
    template <class T>
    BytesWriter& add(T value) {
        const auto at = bytes.size();
        bytes.resize(at + sizeof value);
        std::memcpy(bytes.data() + at, &value, sizeof value);
        return *this;
    }
    BytesWriter& add(const Bytes& more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return *this;
    }
    Bytes bytes;
};

class MemoryFiles final : public import_octree::TreeFiles {
  public:
    std::map<std::string, Bytes> files;

    void write(const std::string& name, std::string_view text) { files[name] = bytesOfText(text); }

    Expected<std::unique_ptr<import_octree::TreeFile>> open(const std::string& name) const override {
        const auto found = files.find(name);
        if (found == files.end()) return fail(ErrorCode::NotFound, "its file " + name + " is missing");
        return std::make_unique<File>(found->second, name);
    }
    Expected<std::vector<import_octree::TreeEntry>> list(const std::string& folder) const override {
        std::vector<import_octree::TreeEntry> entries;
        for (const auto& [name, bytes] : files) {
            if (!name.starts_with(folder + "/")) continue;
            const auto rest = name.substr(folder.size() + 1);
            const auto slash = rest.find('/');
            const import_octree::TreeEntry entry{rest.substr(0, slash), slash != std::string::npos};
            if (entries.empty() || entries.back().name != entry.name) entries.push_back(entry);
        }
        if (entries.empty()) return fail(ErrorCode::NotFound, "its file " + folder + " is missing");
        return entries;
    }

  private:
    class File final : public import_octree::TreeFile {
      public:
        File(const Bytes& bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
        std::uint64_t bytes() const override { return bytes_.size(); }
        Expected<void> read(std::uint64_t offset, std::span<std::byte> into) const override {
            if (offset > bytes_.size() || into.size() > bytes_.size() - offset)
                return fail(ErrorCode::Truncated, "its file " + name_ + " ends within its points");
            if (!into.empty()) std::memcpy(into.data(), bytes_.data() + offset, into.size());
            return {};
        }

      private:
        const Bytes& bytes_;
        std::string name_;
    };
};

/// A whole scan as its reader gets it.
struct ReadScan {
    ScanHeader header;
    PointBatch points;
    std::vector<std::string> notes;
    std::uint64_t dropped = 0;
};

inline Expected<ReadScan> readStream(const Bytes& stream) {
    auto source = PointStreamReader::create(std::make_unique<MemoryByteSource>(stream));
    if (!source) return passOn(source);
    ReadScan scan{(*source)->header(), {}, {}, 0};
    PointBatch batch;
    for (;;) {
        const auto more = (*source)->read(batch);
        if (!more) return passOn(more);
        if (!*more) break;
        append(scan.points, batch);
    }
    scan.notes = (*source)->notes();
    scan.dropped = (*source)->droppedPoints();
    return scan;
}

/// Through the point stream, as it would go through a pipe.
inline Expected<ReadScan> readOctree(const import_octree::TreeFiles& files, const std::string& description,
                                     bool keepAttributes = false) {
    const auto octree = import_octree::openOctree(files, description, keepAttributes);
    if (!octree) return passOn(octree);
    Bytes stream;
    PointStreamWriter writer([&](std::span<const std::byte> bytes) {
        stream.insert(stream.end(), bytes.begin(), bytes.end());
        return true;
    });
    if (auto ok = import_octree::writeOctree(**octree, writer); !ok) return passOn(ok);
    return readStream(stream);
}

}  // namespace scancast::test
