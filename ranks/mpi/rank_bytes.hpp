// What ranks send each other and the front before them. A plain value.
#pragma once

#include <cstddef>
#include <vector>

namespace scancast {

/// (Bytes are a picture's, renderer/image/encode.hpp.)
using RankBytes = std::vector<std::byte>;

}  // namespace scancast
