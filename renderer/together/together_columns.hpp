// Several clouds coloured and filtered by columns: each by its own, over the same values at the colour map's ends; every cloud that is shown
// must have them. Pipeline: together + style → **pictured stores** → select, provide. Any thread; waits for nothing.
#pragma once

#include <memory>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// picturedOctree() of one cloud, or of several: then its nodes are the cloud's, and its samples those of its members' pictured
/// octrees. nullptr: the style asks for none. Errors: picturedOctree()'s, with the cloud's name where there are several.
Expected<std::shared_ptr<const Octree>> picturedOctreeOf(const Cloud& cloud, const Style& style);

/// The style with its range said, where its colour is a column of several clouds: around what each would take.
Style withColumnEnds(const Cloud& cloud, Style style);

}  // namespace scancast
