// A node while the octree grows: owned by its parent, worked on by one task at a time.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "renderer/cloud/build/nodes/average.hpp"
#include "renderer/cloud/build/nodes/leaf.hpp"
#include "renderer/cloud/build/workspace.hpp"
#include "renderer/cloud/file/block_place.hpp"

namespace scancast {

/// Gives a vector's room back; assigning {} would keep it.
template <class T>
void giveBack(std::vector<T>& values) {
    std::vector<T>().swap(values);
}

/// Whether a node is drawn as oriented, with what is not sure in it two-sided. Else all of it is.
inline bool mostlySure(std::uint64_t sure, std::uint64_t points) {
    return 2 * sure > points;
}

/// Planes of one node; of nothing where all of it is 0.
struct BesidePlaces {
    BlockPlace curvature, nearInfrared;
};

struct BuildNode {
    std::span<BuildPoint> points;        ///< everything below, while its chunk is in memory
    std::vector<BuildPoint> keptPoints;  ///< a leaf's, until its parent in another chunk has averaged them
    std::uint64_t pointCount = 0;
    GridBox box;
    int level = 0;
    NodeContent content;
    AverageList averages;  ///< of an inner node, until its parent has used it
    Workspace::Buffer
        setAside;  ///< an inner node's samples and all that goes with them, between averaging and finishing
    StoredNode stored;                  ///< its place in the file, and sampleCount: samples may be away
    std::vector<BlockPlace> columns;    ///< a leaf's kept columns in the file
    std::vector<BlockPlace> positions;  ///< a leaf's on the scan's grid, where its samples round them
    BesidePlaces beside;                ///< what stands beside its samples, in the file
    std::uint64_t sampleHash = 0;
    std::uint8_t confidence = 0;   ///< as in Node
    std::uint64_t surePoints = 0;  ///< below, whose side is sure
    BuildNode* parent = nullptr;
    std::size_t finishedChildren = 0;
    std::vector<std::unique_ptr<BuildNode>> children;

    bool isLeaf() const { return children.empty(); }
};

}  // namespace scancast
