// The octree that a view draws when it asks for columns: the cloud's own nodes, with samples coloured and filtered before any device
// sees them (renderer/cloud/columns). Their blocks lie in the block cache, within the one limit for all clouds; views with the same
// words share them. Pipeline: plan → **pictured octree** → select, provide.
//
// *Thread safety*: any thread; reads nothing from disk.
#pragma once

#include <memory>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/columns/column_choice.hpp"

namespace scancast {

/// nullptr: the view asks for none, and draws the cloud's own. The cloud's store keeps those used last (DerivedOctrees). Errors:
/// chooseColumns()'s; Unsupported where not all samples are in this process (ranks).
Expected<std::shared_ptr<const Octree>> picturedOctree(const Cloud& cloud, const Style& style);

/// A cloud in memory as a cloud file that does not keep it: what is asked once it is gone is Cancelled. Its store has a gate.
std::shared_ptr<const CloudFile> fileOfSamples(const Cloud& cloud);
/// The same of a cloud whose samples come from another store: with other colours (renderer/together).
Expected<std::shared_ptr<const Octree>> picturedOctree(const Cloud& cloud, SampleStore& store,
                                                       const Style& style);

/// The cloud with the octree that the style's filter leaves, its colours as they are: for who looks at points rather than pictures.
/// `cloud` itself where there is no filter. Errors: picturedOctree()'s.
Expected<std::shared_ptr<const Cloud>> filteredCloud(std::shared_ptr<const Cloud> cloud, Style style);

/// Whether columns can be chosen of every node: none of it is an inner one, or its file has their values.
bool hasInnerNodes(const Octree& octree);

}  // namespace scancast
