// Opens the device that is measured or compared, or ends the program with a sentence that tells what is
// missing.
#pragma once

#include <memory>

#include "renderer/device/device.hpp"

namespace scancast::bench {

/// Exit codes that scripts and tests can tell apart.
inline constexpr int noDevice = 3, noHardware = 4, wrongPicture = 5;

/// What two devices owe each other, dB.
inline constexpr double owedDecibels = 45;

/// Ends with noDevice where nothing opens, and with noHardware where hardware is required and what opened is
/// none; then all drivers that were found are listed, with the reasons of those that did not open.
std::unique_ptr<Device> openOrExit(const DeviceOptions& options, bool requireHardware);

/// What the driver says: Markdown, one line a fact.
void printDevice(const DeviceInfo& info);

}  // namespace scancast::bench
