#include "server/commands/backends.hpp"

#include <gtest/gtest.h>

#include <array>

namespace scancast {
namespace {

TEST(Backends, ALineHowToAskForItAndOneWhatItIs) {
    DeviceInfo gpu, rasteriser, cpu, missing;
    gpu.name = "egl";
    gpu.vendor = "NVIDIA Corporation";
    gpu.renderer = "NVIDIA H100";
    gpu.version = "4.6.0 NVIDIA 535";
    gpu.hardware = gpu.atomics64 = true;
    gpu.memory = std::uint64_t{80} << 30;
    gpu.eglDevice = 0;
    gpu.node = "/dev/dri/renderD128";
    rasteriser.name = "egl";
    rasteriser.vendor = "Mesa";
    rasteriser.renderer = "llvmpipe";
    rasteriser.version = "4.5";
    rasteriser.eglDevice = 1;
    rasteriser.exact = false;
    cpu.name = "cpu";
    cpu.vendor = "Scancast";
    cpu.renderer = "x86-64-v3";
    cpu.version = "kernels 1";
    missing.name = "osmesa";
    missing.version = "Install libosmesa6.";
    const std::array all{gpu, cpu, rasteriser, missing};
    EXPECT_EQ(backendsText(all),
              "--backend=egl --egl-device=0    NVIDIA H100\n"
              "    NVIDIA Corporation, 4.6.0 NVIDIA 535, hardware, 80.0 GiB of memory, 64-bit atomics, "
              "rounds exactly, tells resets, /dev/dri/renderD128\n"
              "--backend=cpu                   x86-64-v3\n"
              "    Scancast, kernels 1\n"
              "--backend=egl --egl-device=1    llvmpipe\n"
              "    Mesa, 4.5, software, memory unknown, no 64-bit atomics, rounds approximately\n"
              "--backend=osmesa                does not open\n"
              "    Install libosmesa6.\n"
              "hardware: tried on one GPU so far, an NVIDIA H100 (driver 580). Others are expected to work; "
              "if one does not,\n"
              "    --backend=cpu draws the same pictures (docs/backends.md).\n");
}

TEST(Backends, WithoutAGpuNothingIsSaidOfOne) {
    DeviceInfo rasteriser, missing;
    rasteriser.name = "egl";
    rasteriser.renderer = "llvmpipe";
    missing.name = "egl";
    missing.hardware = true;
    missing.version = "Mount /dev/dri.";
    EXPECT_EQ(backendsText(std::array{rasteriser, missing}).find("hardware:"), std::string::npos);
}

}  // namespace
}  // namespace scancast
