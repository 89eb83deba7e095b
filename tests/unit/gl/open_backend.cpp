// Opens one backend and prints what came of it: libraries are opened once a process, so tests of what is
// missing need a process each. `open_backend NAME [EGL-DEVICE]`
#include <cstdio>
#include <cstdlib>

#include "renderer/device/device.hpp"

int main(int argc, char** argv) {
    scancast::DeviceOptions options;
    if (argc > 1) options.backend = argv[1];
    if (argc > 2) options.eglDevice = std::atoi(argv[2]);
    const auto device = scancast::createDevice(options);
    if (device) {
        std::printf("opened %s\n", (*device)->info().name.c_str());
    } else {
        std::printf("%s\n", device.error().message.c_str());
    }
}
