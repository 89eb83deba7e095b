// The device of a front: what was prepared for the ranks they draw, byte for byte as the cpu device does; what has its samples here, it
// draws itself. Owned by one thread, as every device. Place: provide() → **front's device** → keeper, or cpu device.
#pragma once

#include <memory>

#include "ranks/front/front_clouds.hpp"
#include "ranks/front/job_keeper.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

/// `threads`: of its own drawing. The keeper outlives it. Its draw() says Unavailable for what was prepared for ranks that are not there
/// any more: prepared again, it draws it. Errors: createCpuDevice()'s.
Expected<std::unique_ptr<Device>> createFrontDevice(JobKeeper& keeper,
                                                    std::shared_ptr<const FrontClouds> clouds, int threads);

}  // namespace scancast
