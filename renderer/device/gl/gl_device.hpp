// The `gl` device: every pass a compute shader on OpenGL 4.5 core, without a window, by EGL or OSMesa.
//
// It draws what the cpu device draws, pass by pass and in the same order of operations, from the same numbers
// (renderer/device/host); a picture's pixels are read back while the next one is begun (picture.hpp). The
// context is current only inside calls, so several GL devices may live on one thread.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/device/device.hpp"
#include "renderer/device/gl/programs/arithmetic.hpp"

namespace scancast {

/// What is not the context's: see DeviceOptions.
struct GlOptions {
    std::filesystem::path programFolder{};  ///< empty = nothing is kept from run to run
    std::uint64_t gpuMemoryLimit = 0;       ///< bytes; 0 = by default (memory_limit.hpp), as the next one
    std::uint64_t uploadBudget = 0;         ///< bytes
    std::optional<bool> sumTiles{};         ///< for benchmarks: splat_limits.hpp
    std::optional<gl::Arithmetic> arithmetic{};  ///< for tests; nullopt = what fits the driver
};

/// `device` as listed by listEglDevices(); -1 = best. DeviceUnavailable says what is missing and how to get
/// it.
Expected<std::unique_ptr<Device>> createEglDevice(int device, const GlOptions& options = {});
Expected<std::unique_ptr<Device>> createOsmesaDevice(const GlOptions& options = {});

/// Opens only what claims to be a GPU: quick where there is none.
Expected<std::unique_ptr<Device>> createHardwareEglDevice(const GlOptions& options = {});

/// Every EGL device, then OSMesa; what does not open carries the reason in `version`.
std::vector<DeviceInfo> listGlDevices();

}  // namespace scancast
