// Nodes of an octree that are files of LAS or LAZ: opened one by one, held against each other, and read as records. Built by
// one thread; then its const functions from any. Pipeline: hierarchy → **tiles** → records → points.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "importers/octree/tree/octree.hpp"
#include "renderer/cloud/import/las/las_header.hpp"

namespace scancast::import_octree {

class LasTiles {
  public:
    /// `files` outlives it. `keep`: fill rows with what LAS knows besides.
    LasTiles(const TreeFiles& files, bool keep) : files_(files), keep_(keep) {}

    /// Opens a file of LAS or LAZ. How many points it has; one without is none of the tiles. Errors, which name it: those of
    /// opening it; Unsupported for what differs from the tiles before in what points have.
    Expected<std::uint64_t> add(const std::string& name);

    std::size_t size() const { return tiles_.size(); }
    bool haveColors() const { return color_; }
    /// Whether the positions of all are steps of one grid.
    bool haveOneGrid() const { return oneGrid_; }
    /// What the tiles say of the scan: attributes, columns, grid where it is the same for all; CRS where the header has none.
    void describe(ScanHeader& header) const;

    std::uint64_t memoryOf(std::size_t tile) const;
    /// Octree::read().
    Expected<void> read(std::size_t tile, const Wanted& wanted, const Octree::TakeRecords& take) const;

  private:
    struct Tile {
        std::string name;
        std::uint64_t points = 0;
        std::uint32_t recordBytes = 0;
    };

    Expected<void> compare(const ScanHeader& scan, const std::string& name);

    const TreeFiles& files_;
    bool keep_;
    std::vector<Tile> tiles_;
    ScanHeader first_;  ///< of the first tile
    bool color_ = false, sameGrid_ = true, oneGrid_ = false;
};

}  // namespace scancast::import_octree
