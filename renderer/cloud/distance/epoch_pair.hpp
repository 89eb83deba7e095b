// The two epochs, opened, and whether there are distances between them. Pipeline: files → **pair** → distances.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/distance/epoch_distance.hpp"
#include "renderer/cloud/file/cloud_file.hpp"

namespace scancast {

struct EpochPair {
    /// Each has a node, and each node a sample: open() sees to that.
    std::shared_ptr<const CloudFile> after, before;
    std::string unit;                  ///< of distances: "metre"; empty = not known
    std::vector<std::string> remarks;  ///< as DistanceReport's
};

/// Errors: as measureDistance().
Expected<EpochPair> openEpochs(const DistanceOptions& options);

/// Whether `facts` can have another column of that name. InvalidArgument, field `name`.
Expected<void> checkColumnName(const std::string& name, const CloudFacts& facts);

}  // namespace scancast
