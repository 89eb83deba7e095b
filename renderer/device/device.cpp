// Chooses a device by its backend's name and lists those that would open here.
#include "renderer/device/device.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "renderer/device/cpu/cpu_device.hpp"
#include "renderer/device/gl/gl_device.hpp"

namespace scancast {
namespace {

GlOptions glOptions(const DeviceOptions& options) {
    return {options.programFolder, options.gpuMemoryLimit, options.uploadBudget, options.sumTiles};
}

Expected<std::unique_ptr<Device>> createBest(const DeviceOptions& options) {
    auto gpu = createHardwareEglDevice(glOptions(options));
    if (gpu) return gpu;
    spdlog::debug("Drawing on the CPU: {}", gpu.error().message);
    return createCpuDevice(options.threads);
}

}  // namespace

std::string title(const DeviceInfo& device) {
    return device.renderer.empty() ? device.name : device.name + " (" + device.renderer + ")";
}

Expected<std::unique_ptr<Device>> createDevice(const DeviceOptions& options) {
    if (options.eglDevice >= 0 && options.backend != "egl" && options.backend != "auto")
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("--egl-device chooses among EGL's devices; it needs --backend=egl, not {}.",
                                options.backend),
                    "egl-device");
    if (options.eglDevice < -1)
        return fail(
            ErrorCode::InvalidArgument,
            fmt::format(
                "--egl-device takes a number from 0, as --list-backends counts, or -1 for the best; not {}.",
                options.eglDevice),
            "egl-device");
    if (options.backend == "cpu") return createCpuDevice(options.threads);
    if (options.backend == "osmesa") return createOsmesaDevice(glOptions(options));
    if (options.backend == "egl" || (options.backend == "auto" && options.eglDevice >= 0))
        return createEglDevice(options.eglDevice, glOptions(options));
    if (options.backend == "auto") return createBest(options);
    return fail(
        ErrorCode::InvalidArgument,
        fmt::format("There is no backend \"{}\": choose auto, cpu, egl or osmesa, for example --backend=cpu. "
                    "--list-backends shows what works here.",
                    options.backend),
        "backend");
}

std::vector<DeviceInfo> listDevices() {
    std::vector<DeviceInfo> infos = listGlDevices();
    DeviceInfo cpu;
    if (auto device = createCpuDevice(0)) {
        cpu = (*device)->info();
    } else {
        cpu.name = "cpu";
        cpu.version = device.error().message;
    }
    infos.push_back(std::move(cpu));
    // GPUs come first, then the processor, then OpenGL on the processor, then what does not open.
    const auto rank = [](const DeviceInfo& info) {
        const bool opens = !info.renderer.empty();
        return !opens ? 3 : info.hardware ? 0 : info.name == "cpu" ? 1 : 2;
    };
    std::ranges::stable_sort(infos, {}, rank);
    return infos;
}

}  // namespace scancast
