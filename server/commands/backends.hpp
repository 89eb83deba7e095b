// What `scancast --list-backends` prints: everything that could draw here, best first, and why the rest does
// not. A pure function; any thread.
#pragma once

#include <span>
#include <string>

#include "renderer/device/device.hpp"

namespace scancast {

/// Two lines for each: how to ask for it and what it is; then vendor, version, memory and the like - or what
/// is missing, and how to get it.
std::string backendsText(std::span<const DeviceInfo> devices);

}  // namespace scancast
