// From the samples in the machine's memory to those that a device has in its own: what a picture that need
// not be complete can draw at once, without an upload longer than a frame. Complete pictures need none of
// this: drawing uploads whatever it lacks. Pipeline: select → provide → **on the device** → drawing.
#pragma once

#include <span>
#include <stop_token>

#include "renderer/residency/device_memory.hpp"
#include "renderer/select/select.hpp"

namespace scancast {

/// The cuts of one picture, at least one, all of this octree, with their samples, all or none with what stands beside those. Moves to
/// the device what it lacks of them, within its budget for a frame, most urgent first, as provide() asks for blocks; whole runs that
/// are not there even so are replaced by ancestors, by provide()'s rule, and counted as missing. Something
/// always gets there, and the roots always are, so there are no holes, and each picture of a view that rests
/// has more than the one before, until all of it is there. On the device's thread. Errors: those of
/// DeviceMemory::bring().
Expected<void> provideOnDevice(const Octree& octree, std::span<Cut* const> cuts, DeviceMemory& memory,
                               const std::stop_token& stop);

}  // namespace scancast
