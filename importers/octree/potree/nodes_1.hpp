// The nodes of a Potree 1 octree: what its hierarchy says of them - .hrc files (1.5-1.8) or cloud.js itself (up to 1.4) -,
// and which files there are. The files are the truth: the usual converter writes 0 for every leaf into its .hrc files,
// leaves old counts in those that it need not write again, and does not tell the file above of a file's later children.
// Pipeline: description → **nodes** → points.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "importers/octree/tree/tree_files.hpp"

namespace scancast::import_octree {

/// Where the files of an octree of Potree 1 are.
struct PotreePlace {
    std::string folder;     ///< "data"
    std::size_t step = 0;   ///< levels of a folder, and of a .hrc file; 0 = all files beside each other
    std::string extension;  ///< "bin", "las", "laz"

    std::string fileOf(const std::string& name) const;
    std::string hierarchyOf(const std::string& name) const;
};

/// A node that has a file, and what that holds.
struct HeldNode {
    std::string name;
    std::uint64_t points = 0;
};

/// Name → points.
using ListedNodes = std::map<std::string, std::uint32_t, std::less<>>;

/// As `cloud.hierarchy` has them. Errors: Malformed.
Expected<ListedNodes> listedInJson(const nlohmann::json& list);
/// As the .hrc files have them, one for every `step` levels. Errors: Malformed, those of reading; they name the file.
Expected<ListedNodes> listedInFiles(const TreeFiles& files, const PotreePlace& place);

/// The names of all nodes that have a file, level after level. Errors: Malformed, those of reading.
Expected<std::vector<std::string>> nodesWithFiles(const TreeFiles& files, const PotreePlace& place);

/// What the hierarchy says of the points against what the files hold: the files are right, and every difference is a note.
/// Malformed when the file of a node is missing that may have points: 0 points are believed as long as no other node of 0
/// points has some.
Expected<std::vector<std::string>> checkNodes(const std::vector<HeldNode>& nodes, const ListedNodes& listed,
                                              const PotreePlace& place);

}  // namespace scancast::import_octree
