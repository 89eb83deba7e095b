#include "server/commands/file_info.hpp"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "renderer/cloud/build/value_ranges.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/import/open_scan.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

OctreeInfo octreeInfo(std::span<const StoredNode> nodes) {
    OctreeInfo info;
    for (const StoredNode& stored : nodes) {
        ++info.nodes;
        info.leaves += stored.node.isLeaf();
        info.samples += stored.node.sampleCount;
        info.levels = std::max(info.levels, stored.node.level + 1);
    }
    return info;
}

/// What cannot be fetched now is not damaged: the error is Unavailable.
Expected<std::vector<DamagedBlock>> checkBlocks(const CloudFile& file, const ProgressSink& progress) {
    std::vector<DamagedBlock> damaged;
    const auto isAway = [](const auto& read) { return !read && read.error().code == ErrorCode::Unavailable; };
    const auto nodes = file.nodes();
    constexpr std::uint32_t nodesPerReport = 64;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (const auto samples = file.samples(i); isAway(samples))
            return passOn(samples);
        else if (!samples)
            damaged.push_back({i, {}, nodes[i].samples.offset, samples.error().message});
        std::uint64_t last = 0;
        for (std::size_t p = 0; p < file.planes().size(); ++p) {
            // Columns of a version 1 file are one block.
            if (const std::uint64_t offset = file.planePlace(i, p).offset;
                std::exchange(last, offset) == offset)
                continue;
            if (const auto plane = file.plane(i, p); isAway(plane))
                return passOn(plane);
            else if (!plane)
                damaged.push_back({i, {}, last, plane.error().message});
        }
        if (progress && (i % nodesPerReport == 0 || i + 1 == nodes.size()))
            progress({"checking", i + std::uint64_t(1), nodes.size(), "nodes"});
    }
    const std::vector<Photo>& photos = file.facts().photos;
    for (std::uint32_t i = 0; i < photos.size(); ++i) {
        if (const auto bytes = photos[i].data->read(); isAway(bytes))
            return passOn(bytes);
        else if (!bytes)
            damaged.push_back({{}, i, file.photoPlaces()[i].offset, bytes.error().message});
        if (progress) progress({"checking", i + std::uint64_t(1), photos.size(), "photos"});
    }
    return damaged;
}

Expected<FileInfo> cloudInfo(const CloudFile& file, bool check, const ProgressSink& progress) {
    FileInfo info;
    info.file = file.path();
    info.bytes = file.bytes();
    info.facts = file.facts();
    info.points = file.facts().points;
    info.boundsKnown = true;
    info.octree = octreeInfo(file.nodes());
    info.writtenBy = file.writtenBy();
    if (const auto& grid = file.facts().grid) info.gridStep = grid->step;
    if (check) {
        auto damaged = checkBlocks(file, progress);
        if (!damaged) return passOn(std::move(damaged));
        info.damaged = std::move(*damaged);
    }
    info.checked = check;
    return info;
}

Expected<FileInfo> cloudInfo(const ScanInput& input, bool check, const ProgressSink& progress) {
    auto shared = input.file().share();
    if (!shared) return passOn(shared);
    const auto opened = CloudFile::open(std::move(*shared));
    if (!opened) return passOn(opened);
    auto info = cloudInfo(**opened, check, progress);
    if (info) info->file = input.path();
    return info;
}

/// What the points themselves say, in place of what the header declares.
class Counted {
  public:
    void add(const PointBatch& batch) {
        const auto [low, high] = boundsOf(batch.position);
        low_ = glm::min(low_, low), high_ = glm::max(high_, high);
        values_.add(batch);
        for (const std::uint8_t c : batch.classification) ++classes_[c];
        points_ += batch.size();
    }

    void tell(FileInfo& info, const PointSource& source) const {
        info.points = info.facts.points = points_;
        info.facts.droppedPoints = source.droppedPoints();
        info.facts.notes = source.notes();
        for (std::string& note : values_.notes(points_)) info.facts.notes.push_back(std::move(note));
        info.facts.stations = source.stations();
        info.facts.photos = source.photos();
        info.facts.bounds = {low_, high_};
        info.boundsKnown = points_ > 0;
        values_.settle(info.facts);
        info.facts.classCounts = classes_;
        info.checked = true;
    }

  private:
    glm::dvec3 low_{std::numeric_limits<double>::max()}, high_{std::numeric_limits<double>::lowest()};
    ValueRanges values_;
    std::array<std::uint64_t, 256> classes_{};
    std::uint64_t points_ = 0;
};

Expected<void> readThrough(PointSource& source, FileInfo& info, const ProgressSink& progress) {
    Counted counted;
    std::uint64_t done = 0;
    PointBatch batch;
    for (;;) {
        const auto more = source.read(batch);
        if (!more) return passOn(more);
        if (!*more) break;
        counted.add(batch);
        done += batch.size();
        if (progress) progress({"reading", done, source.header().points.value_or(0), "points"});
    }
    counted.tell(info, source);
    return {};
}

Expected<FileInfo> scanInfo(const ScanInput& input, bool check, const ProgressSink& progress) {
    ImportOptions options;
    options.keepAttributes = true;
    auto source = openScan(input, options);
    if (!source) return passOn(source);
    const ScanHeader& header = (*source)->header();
    FileInfo info;
    info.file = input.path();
    info.bytes = input.bytes();
    info.points = header.points;
    info.facts.title = input.path().filename().string();
    info.facts.format = header.format;
    info.facts.points = header.points.value_or(0);
    info.facts.attributes = header.attributes;
    info.facts.crsWkt = header.crsWkt;
    info.facts.crsEpsg = header.crsEpsg;
    info.facts.notes = (*source)->notes();
    info.facts.stations = (*source)->stations();
    info.facts.photos = (*source)->photos();
    for (const Column& column : header.columns) info.facts.columns.push_back({column, {0, 0}});
    info.boundsKnown = header.bounds.has_value();
    if (header.bounds) info.facts.bounds = *header.bounds;
    info.gridStep = header.gridStep;
    info.scannerOrigin = header.scannerOrigin;
    auto mirrors = input.mirrors();
    if (!mirrors) return passOn(mirrors);
    info.facts.mirrors = std::move(*mirrors);
    if (check)
        if (auto ok = readThrough(**source, info, progress); !ok) return passOn(ok);
    return info;
}

/// A cloud file that was never finished begins with zeros, which no scan does.
bool looksLikeCloudFile(const InputFile& file) {
    std::array<std::byte, 64> start{};
    const auto got = file.readAt(0, start);
    const auto there = std::span(start).first(got.value_or(0));
    return isCloudFile(there) || (!there.empty() && std::all_of(there.begin(), there.end(), [](std::byte b) {
               return b == std::byte(0);
           }));
}

}  // namespace

Expected<FileInfo> fileInfo(const fs::path& file, bool check, const ProgressSink& progress) {
    const auto input = ScanInput::open(file);
    if (!input) return passOn(input);
    return looksLikeCloudFile(input->file()) ? cloudInfo(*input, check, progress)
                                             : scanInfo(*input, check, progress);
}

Expected<FileInfo> remoteInfo(RemoteFiles& remote, const std::string& url, bool check,
                              const ProgressSink& progress) {
    const auto opened = openRemoteCloud(remote, url, {.look = false});
    if (!opened) return passOn(opened);
    return cloudInfo(*opened->file, check, progress);
}

}  // namespace scancast
