// What bench_gpu is asked to do: its command line. Parsed once, by main().
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "renderer/device/device.hpp"

namespace scancast::bench {

struct Size {
    int width = 0, height = 0;
    bool operator==(const Size&) const = default;
};

struct Settings {
    DeviceOptions device{.backend = "egl"};
    bool requireHardware = false;
    std::string scene = "town";
    std::vector<std::uint64_t> points{10'000'000, 100'000'000, 796'000'000};
    std::vector<Size> sizes{{1248, 768}, {1920, 1080}, {3840, 2160}};
    std::vector<std::string> methods;  ///< all but `auto`
    int repeat = 30;
    double warmUp = 1;  ///< s, before each row
    bool surfels = true;
    bool compare = false;            ///< each picture with the cpu device's, before it is timed
    bool anyway = false;             ///< times pictures that are wrong, too
    std::filesystem::path pictures;  ///< folder for pictures of the first size; empty = none
    std::filesystem::path json;      ///< empty = none
};

/// Ends the program, with a sentence and exit code 2, where the words make no sense.
Settings settingsFrom(int argc, char** argv);

}  // namespace scancast::bench
