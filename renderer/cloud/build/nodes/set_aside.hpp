// An inner node's samples and all that goes with them, waiting between averaging and finishing, until its neighbours are there.
// Pipeline: averages → **set aside** → finish. BuildNode::setAside holds, one behind the other: samples, reaches, densities, words beside.
#pragma once

#include "renderer/cloud/build/nodes/build_node.hpp"

namespace scancast {

/// Out of the node's content. Errors: the workspace's.
Expected<void> setAside(BuildNode& node, Workspace& workspace);

}  // namespace scancast
