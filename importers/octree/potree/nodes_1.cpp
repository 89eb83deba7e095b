#include "importers/octree/potree/nodes_1.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "files/bytes.hpp"
#include "importers/octree/potree/node_names.hpp"
#include "renderer/cloud/import/octree/json_values.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

constexpr std::size_t hrcEntryBytes = 5;  // u8 children, u32 points
constexpr std::uint64_t longestHrc = std::uint64_t(32) << 20;

tl::unexpected<Error> tooLargeTree(std::size_t nodes) {
    return fail(ErrorCode::Malformed,
                fmt::format("its octree is deeper or larger than any real one ({} nodes)", grouped(nodes)));
}

/// A file holds, level after level, a node and what is below it, `step` levels deep; the deepest of them go on in files of
/// their own: if they have children, or got some after this file was written.
Expected<void> readHrc(const TreeFiles& files, const PotreePlace& place, const std::string& root,
                       ListedNodes& listed, std::vector<std::string>& roots) {
    const auto file = place.hierarchyOf(root);
    const auto bytes = files.readAll(file, longestHrc);
    if (!bytes) return passOn(bytes);
    const auto wrong = [&](const std::string& reason) {
        return fail(ErrorCode::Malformed, "its file " + printableText(file, 200) + reason);
    };
    if (bytes->empty() || bytes->size() % hrcEntryBytes != 0)
        return wrong(fmt::format(" has {} bytes, no multiple of {}", grouped(bytes->size()), hrcEntryBytes));
    std::vector<std::string> names{root};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto at = i * hrcEntryBytes;
        const std::string name = names[i];
        if (at >= bytes->size())
            return wrong(fmt::format(" ends at byte {}, before the node {}", grouped(at), name));
        const unsigned children = loadLe<std::uint8_t>(bytes->data() + at);
        listed[name] = loadLe<std::uint32_t>(bytes->data() + at + 1);
        if (listed.size() + names.size() > mostPotreeNodes || name.size() > longestNodeName)
            return tooLargeTree(listed.size());
        if (name.size() - root.size() < place.step) {
            for (char child = 0; child < 8; ++child)
                if ((children & (1U << child)) != 0) names.push_back(name + static_cast<char>('0' + child));
        } else if (children != 0 || files.has(place.hierarchyOf(name))) {
            roots.push_back(name);
        }
    }
    if (names.size() * hrcEntryBytes != bytes->size())
        return wrong(fmt::format(" has {} bytes; its {} nodes need less", grouped(bytes->size()),
                                 grouped(names.size())));
    return {};
}

/// The name of a node whose file is called so.
std::string_view nodeOfFile(std::string_view file, const std::string& extension) {
    const std::string ending = "." + extension;
    if (!file.ends_with(ending)) return {};
    file.remove_suffix(ending.size());
    return isNodeName(file) ? file : std::string_view();
}

bool areDigits(std::string_view text, std::size_t count) {
    return text.size() == count &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '7'; });
}

}  // namespace

std::string PotreePlace::fileOf(const std::string& name) const {
    return folder + "/" + nodePath(name, step) + "." + extension;
}

std::string PotreePlace::hierarchyOf(const std::string& name) const {
    return folder + "/" + nodePath(name, step) + ".hrc";
}

Expected<ListedNodes> listedInJson(const nlohmann::json& list) {
    if (!list.is_array() || list.empty())
        return fail(ErrorCode::Malformed, "cloud.js: \"hierarchy\" must be a list of nodes");
    ListedNodes listed;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto& entry = list[i];
        const bool isNode = entry.is_array() && entry.size() >= 2 && entry[0].is_string();
        const auto name = isNode ? entry[0].get<std::string>() : std::string();
        if (!isNodeName(name) || name.size() > longestNodeName)
            return fail(ErrorCode::Malformed,
                        fmt::format("cloud.js: node {} of \"hierarchy\" has no name like \"r042\"", i));
        const auto points = countOf(entry[1], "cloud.js: points of " + name, 0xffffffff);
        if (!points) return passOn(points);
        if (!listed.emplace(name, static_cast<std::uint32_t>(*points)).second)
            return fail(ErrorCode::Malformed, "cloud.js: \"hierarchy\" has the node " + name + " twice");
    }
    return listed;
}

Expected<ListedNodes> listedInFiles(const TreeFiles& files, const PotreePlace& place) {
    ListedNodes listed;
    std::vector<std::string> roots{"r"};
    for (std::size_t i = 0; i < roots.size(); ++i) {
        const std::string root = roots[i];
        if (auto ok = readHrc(files, place, root, listed, roots); !ok) return passOn(ok);
    }
    return listed;
}

Expected<std::vector<std::string>> nodesWithFiles(const TreeFiles& files, const PotreePlace& place) {
    struct Folder {
        std::string path, prefix;
    };
    std::vector<std::string> names;
    std::vector<Folder> folders;
    folders.push_back(place.step == 0 ? Folder{place.folder, ""} : Folder{place.folder + "/r", "r"});
    for (std::size_t i = 0; i < folders.size(); ++i) {
        const auto [path, prefix] = folders[i];
        const auto entries = files.list(path);
        if (!entries) return passOn(entries);
        for (const auto& entry : *entries) {
            if (entry.isFolder) {
                const bool goesOn = place.step > 0 && areDigits(entry.name, place.step);
                if (goesOn && prefix.size() + place.step <= longestNodeName)
                    folders.push_back({path + "/" + entry.name, prefix + entry.name});
                continue;
            }
            const std::string name(nodeOfFile(entry.name, place.extension));
            // Where it is looked for, and not a copy elsewhere.
            if (!name.empty() && place.fileOf(name) == path + "/" + entry.name) names.push_back(name);
        }
        if (names.size() > mostPotreeNodes || folders.size() > mostPotreeNodes)
            return tooLargeTree(names.size());
    }
    std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
        return a.size() != b.size() ? a.size() < b.size() : a < b;
    });
    return names;
}

Expected<std::vector<std::string>> checkNodes(const std::vector<HeldNode>& nodes, const ListedNodes& listed,
                                              const PotreePlace& place) {
    std::vector<std::string_view> found;
    bool zerosHold = true;
    const HeldNode* unlisted = nullptr;
    const HeldNode* shorter = nullptr;
    std::uint64_t manyUnlisted = 0, pointsUnlisted = 0, manyShorter = 0;
    for (const auto& node : nodes) {
        found.push_back(node.name);
        const auto said = listed.find(node.name);
        const bool isListed = said != listed.end();
        zerosHold = zerosHold && (node.points == 0 || !isListed || said->second != 0);
        if (!isListed && node.points > 0) {
            unlisted = unlisted ? unlisted : &node;
            ++manyUnlisted;
            pointsUnlisted += node.points;
        }
        if (isListed && node.points < said->second) {
            shorter = shorter ? shorter : &node;
            ++manyShorter;
        }
    }
    std::sort(found.begin(), found.end());
    std::string missing;
    std::uint64_t manyMissing = 0;
    for (const auto& [name, points] : listed) {
        if (std::binary_search(found.begin(), found.end(), name) || (zerosHold && points == 0)) continue;
        const bool isFirst = manyMissing++ == 0 || name.size() < missing.size();
        if (isFirst) missing = name;
    }
    if (manyMissing > 0) {
        const auto more = manyMissing == 1 ? std::string()
                                           : fmt::format(" and so are {} more that its hierarchy has",
                                                         grouped(manyMissing - 1));
        return fail(ErrorCode::Malformed, "its file " + place.fileOf(missing) + " is missing" + more);
    }
    std::vector<std::string> notes;
    if (unlisted)
        notes.push_back(fmt::format(
            "{} of its files ({} points; one is {}) are not in its hierarchy; they were read, too",
            grouped(manyUnlisted), grouped(pointsUnlisted), place.fileOf(unlisted->name)));
    if (shorter)
        notes.push_back(
            fmt::format("{} of its files hold fewer points than its hierarchy says ({} {} of {}); what they "
                        "hold was read",
                        grouped(manyShorter), place.fileOf(shorter->name), grouped(shorter->points),
                        grouped(listed.find(shorter->name)->second)));
    return notes;
}

}  // namespace scancast::import_octree
