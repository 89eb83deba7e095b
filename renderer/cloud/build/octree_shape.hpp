// What decides how an octree looks, whatever builds it: the same shape and points give the same octree.
#pragma once

#include <cstdint>

namespace scancast {

/// How estimated normals are made to point to one side; a scan's own normals stay as they are.
enum class Orientation : std::uint8_t {
    Auto,  ///< towards the scanner that saw each point where the scan says where it stood, else decided by all of them together
    Scan,  ///< towards the scanner where the scan says where it stood, else left as they are: unoriented
    Up,    ///< upwards: airborne scans
};

/// What decides how an octree looks.
struct OctreeShape {
    std::uint32_t leafPoints = 16384;  ///< a leaf holds at most this many points
    std::uint32_t chunkPoints =
        1 << 20;            ///< larger sets are split on a counting grid, so that chunks fit in memory
    bool surfels = false;   ///< estimate normal, radius and ellipse of every sample
    bool curvature = true;  ///< with surfels: and their curvatures, in four bytes more
    int neighbours = 10;    ///< that surfels are estimated from
    Orientation orientation = Orientation::Auto;
    /// In a cloud file: positions beside the samples that round them (exact_columns.hpp).
    bool exact = false;

    bool curvatures() const { return surfels && curvature; }
};

}  // namespace scancast
