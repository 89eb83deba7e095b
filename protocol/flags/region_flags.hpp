// A region as flags of a program: the same in both, and in the same words as over HTTP.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "protocol/points/points_region.hpp"

namespace scancast {

struct RegionFlags {
    std::string clip, clips, classes, filter, polygon, z;

    /// `this` must outlive the parse.
    void addTo(CLI::App& app);
    /// InvalidArgument, with the flag's name as field.
    Expected<PointsRegion> region() const;
};

}  // namespace scancast
