// Potree 1: cloud.js and a file for every node - numbers of its own (BIN), or LAS and LAZ.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "importers/octree/potree/node_names.hpp"
#include "importers/octree/potree/nodes_1.hpp"
#include "importers/octree/potree/potree_layout.hpp"
#include "importers/octree/potree/potree_octree.hpp"
#include "importers/octree/tree/las_tiles.hpp"
#include "renderer/cloud/import/octree/json_values.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

using nlohmann::json;

constexpr std::uint64_t mostStep = 30;
constexpr int firstWithSteps = 5;  // 1.5 has .hrc files, in folders of several levels
constexpr int lastWithFloats = 3;  // up to 1.3, positions are numbers of type float in the file's own unit

/// 7 of "1.7".
std::optional<int> minorVersion(const std::string& version) {
    if (!version.starts_with("1.") || version.size() < 3 ||
        !std::isdigit(static_cast<unsigned char>(version[2])))
        return std::nullopt;
    return std::atoi(version.substr(2, 3).c_str());
}

json corner(const json& box, const char* x, const char* y, const char* z) {
    return json::array({valueAt(box, x), valueAt(box, y), valueAt(box, z)});
}
json lowCorner(const json& box) {
    return corner(box, "lx", "ly", "lz");
}
json highCorner(const json& box) {
    return corner(box, "ux", "uy", "uz");
}

/// What cloud.js says of the scan in common.
void describeScan(const json& cloud, const std::string& kind, ScanHeader& header) {
    header.format = fmt::format("Potree {}, {}", printableText(wordOf(valueAt(cloud, "version")), 20), kind);
    const auto& tight = valueAt(cloud, "tightBoundingBox");
    const auto& box = tight.is_null() ? valueAt(cloud, "boundingBox") : tight;
    header.bounds = boundsOf(lowCorner(box), highCorner(box));
    takeCrs(wordOf(valueAt(cloud, "projection")), header);
}

Expected<PotreePlace> placeOfNodes(const TreeFiles& files, const json& cloud, int minor) {
    const auto& folder = valueAt(cloud, "octreeDir");
    if (!folder.is_null() && !folder.is_string())
        return fail(ErrorCode::Malformed, "cloud.js: \"octreeDir\" must be a folder");
    PotreePlace place{folder.is_null() ? "data" : folder.get<std::string>(), 0, "bin"};
    if (auto there = files.list(place.folder); !there) return passOn(there);
    if (minor < firstWithSteps) return place;
    const auto step = countOf(valueAt(cloud, "hierarchyStepSize"), "\"hierarchyStepSize\"", mostStep);
    if (!step) return passOn(step);
    if (*step == 0) return fail(ErrorCode::Malformed, "cloud.js: \"hierarchyStepSize\" is 0");
    place.step = static_cast<std::size_t>(*step);
    return place;
}

/// Nodes that are files of LAS or LAZ.
class LasPotree final : public Octree {
  public:
    LasPotree(const TreeFiles& files, bool keep) : tiles_(files, keep) {}

    Expected<std::vector<HeldNode>> open(const json& cloud, const std::vector<std::string>& names,
                                         const PotreePlace& place) {
        std::vector<HeldNode> nodes;
        for (const auto& name : names) {
            const auto points = tiles_.add(place.fileOf(name));
            if (!points) return passOn(points);
            nodes.push_back({name, *points});
        }
        describeScan(cloud, wordOf(valueAt(cloud, "pointAttributes")), header_);
        tiles_.describe(header_);
        mayHaveWideColors_ = tiles_.haveColors();
        areSteps_ = tiles_.haveOneGrid();
        return nodes;
    }
    void finish(std::vector<std::string> notes, std::optional<std::uint64_t> said, std::uint64_t held) {
        notes_ = std::move(notes);
        takeDeclaredPoints("cloud.js", said, held, header_, notes_);
    }

    std::size_t pieces() const override { return tiles_.size(); }
    std::uint64_t memoryOf(std::size_t piece) const override { return tiles_.memoryOf(piece); }
    Expected<void> read(std::size_t piece, const Wanted& wanted, const TakeRecords& take) const override {
        return tiles_.read(piece, wanted, take);
    }

  private:
    LasTiles tiles_;
};

/// Nodes that are records one behind the other.
class BinPotree final : public Octree {
  public:
    BinPotree(const TreeFiles& files, PotreePlace place, PotreeLayout layout, bool keep)
        : files_(files), place_(std::move(place)), layout_(std::move(layout)), keep_(keep) {}

    Expected<std::vector<HeldNode>> open(const json& cloud, const std::vector<std::string>& names,
                                         bool floats) {
        const auto& box = valueAt(cloud, "boundingBox");
        const auto low = vectorOf(lowCorner(box), "\"boundingBox\"");
        if (!low) return passOn(low);
        const auto high = vectorOf(highCorner(box), "\"boundingBox\"");
        if (!high) return passOn(high);
        const auto scale = floats ? Expected<double>(1) : numberOf(valueAt(cloud, "scale"), "\"scale\"");
        if (!scale) return passOn(scale);
        low_ = *low;
        size_ = *high - *low;
        scale_ = glm::dvec3(*scale);
        if (auto ok = checkGrid(scale_, *high, "cloud.js"); !ok) return passOn(ok);
        std::vector<HeldNode> nodes;
        for (const auto& name : names) {
            const auto points = pointsOf(name);
            if (!points) return passOn(points);
            nodes.push_back({name, *points});
            if (*points > 0) nodes_.push_back(nodes.back());
        }
        describeScan(cloud, "BIN", header_);
        header_.attributes = layout_.points.attributes();
        if (keep_) header_.columns = columnsOf(layout_.points.kept());
        mayHaveWideColors_ = layout_.points.hasWideColors();
        return nodes;
    }
    void finish(std::vector<std::string> notes, std::optional<std::uint64_t> said, std::uint64_t held) {
        notes_ = std::move(notes);
        takeDeclaredPoints("cloud.js", said, held, header_, notes_);
    }

    std::size_t pieces() const override { return nodes_.size(); }
    std::uint64_t memoryOf(std::size_t piece) const override {
        return slicesMemory(layout_.points.bytes(), nodes_[piece].points);
    }
    Expected<void> read(std::size_t piece, const Wanted& wanted, const TakeRecords& take) const override {
        const auto& [name, points] = nodes_[piece];
        const auto file = files_.open(place_.fileOf(name));
        if (!file) return passOn(file);
        const FieldDecoder decoder(layout_.points, {scale_, cornerOf(name, low_, size_)}, keep_);
        return readPlainRecords(**file, 0, points, wanted, decoder, take);
    }

  private:
    Expected<std::uint64_t> pointsOf(const std::string& name) const {
        const auto path = place_.fileOf(name);
        const auto file = files_.open(path);
        if (!file) return passOn(file);
        const auto bytes = (*file)->bytes();
        const std::uint64_t each = layout_.points.bytes();
        if (bytes % each == 0) return bytes / each;
        return fail(ErrorCode::Malformed,
                    fmt::format("its file {} has {} bytes, no whole number of points of {} bytes", path,
                                grouped(bytes), each));
    }

    const TreeFiles& files_;
    const PotreePlace place_;
    const PotreeLayout layout_;
    const bool keep_;
    glm::dvec3 low_{0}, size_{0}, scale_{1};
    std::vector<HeldNode> nodes_;
};

/// Holds the nodes against the hierarchy.
template <class Potree>
Expected<std::unique_ptr<Octree>> checked(std::unique_ptr<Potree> octree, const std::vector<HeldNode>& nodes,
                                          const ListedNodes& listed, const PotreePlace& place,
                                          const json& cloud) {
    auto notes = checkNodes(nodes, listed, place);
    if (!notes) return passOn(notes);
    std::uint64_t held = 0;
    for (const auto& node : nodes) held += node.points;
    if (held == 0) return fail(ErrorCode::Empty, "it is a Potree octree without points");
    octree->finish(std::move(*notes), declaredPoints(cloud), held);
    return octree;
}

}  // namespace

std::optional<std::uint64_t> declaredPoints(const json& json) {
    const auto points = countOf(valueAt(json, "points"), "", std::uint64_t(1) << 53);
    if (!points) return std::nullopt;
    return *points;
}

Expected<std::unique_ptr<Octree>> openPotree1(const TreeFiles& files, bool keepAttributes) {
    const auto cloud = readJsonObject(files, "cloud.js");
    if (!cloud) return passOn(cloud);
    const auto version = wordOf(valueAt(*cloud, "version"));
    const auto minor = minorVersion(version);
    if (!minor)
        return fail(ErrorCode::Unsupported,
                    fmt::format("cloud.js has version {}; 1.0 to 1.8 are read", quotedText(version)));
    auto place = placeOfNodes(files, *cloud, *minor);
    if (!place) return passOn(place);
    const auto& attributes = valueAt(*cloud, "pointAttributes");
    const auto kind = wordOf(attributes);
    const bool isLas = kind == "LAS" || kind == "LAZ";
    if (isLas) place->extension = kind == "LAS" ? "las" : "laz";
    const auto& list = valueAt(*cloud, "hierarchy");
    const auto listed = list.is_null() ? listedInFiles(files, *place) : listedInJson(list);
    if (!listed) return passOn(listed);
    const auto names = nodesWithFiles(files, *place);
    if (!names) return passOn(names);
    if (isLas) {
        auto octree = std::make_unique<LasPotree>(files, keepAttributes);
        const auto nodes = octree->open(*cloud, *names, *place);
        if (!nodes) return passOn(nodes);
        return checked(std::move(octree), *nodes, *listed, *place, *cloud);
    }
    const bool floats = *minor <= lastWithFloats;
    auto layout = layOutPotree(attributes, floats);
    if (!layout) return passOn(layout);
    auto octree = std::make_unique<BinPotree>(files, *place, std::move(*layout), keepAttributes);
    const auto nodes = octree->open(*cloud, *names, floats);
    if (!nodes) return passOn(nodes);
    return checked(std::move(octree), *nodes, *listed, *place, *cloud);
}

}  // namespace scancast::import_octree
