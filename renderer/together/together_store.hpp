// The samples of several clouds' nodes, each from its cloud's own store. Pipeline: sample stores → **together** → provide().
//
// *Thread safety*: as all sample stores.
#pragma once

#include <memory>

#include "renderer/cloud/sample_store.hpp"
#include "renderer/together/together.hpp"

namespace scancast {

std::shared_ptr<SampleStore> togetherStore(std::shared_ptr<const Together> together);

}  // namespace scancast
