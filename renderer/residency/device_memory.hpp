// What a device with memory of its own keeps there of clouds: the interface that residency sees of it. Place:
// provide() → **device memory** → drawing. On the device's thread, but for what says otherwise.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "protocol/error.hpp"
#include "renderer/select/select.hpp"

namespace scancast {

class DeviceMemory {
  public:
    virtual ~DeviceMemory() = default;
    /// Samples that fit at once; four with what stands beside them (cloud/beside.hpp) take the room of five. From any thread; it never
    /// changes.
    virtual std::uint64_t capacity() const = 0;
    /// Samples that a picture which need not be complete may move there; > 0.
    virtual std::uint64_t frameBudget() const = 0;
    /// Bytes taken now.
    virtual std::uint64_t bytes() const = 0;
    /// Whether all samples of an octree's node are there, and if need be what stands beside them.
    virtual bool has(std::uint64_t source, std::uint32_t node, std::uint32_t samples, bool beside) const = 0;
    /// Moves there what is not there of these nodes, in this order and as many as fit, and counts all of them
    /// as used: what has not been for longest goes. Errors: Cancelled; ResourceLimit, DeviceLost: the
    /// device's.
    virtual Expected<void> bring(std::uint64_t source, std::span<const CutRun> runs,
                                 const std::stop_token& stop) = 0;
};

}  // namespace scancast
