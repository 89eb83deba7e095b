// What a cloud's samples can be coloured by. Pure; any thread.
#pragma once

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Attributes that are the same everywhere are not offered, but drawn when asked for: they are what the scan has. Of columns: whether
/// there can be any, not which.
bool canColorBy(const CloudFacts& cloud, ColorSource source);

}  // namespace scancast
