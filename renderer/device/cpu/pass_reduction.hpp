// What devices that draw one picture together - each a share of the samples - agree on between splat passes: the
// smallest keys, sums of sums, and the pixels that only the owner of a sample can colour. All of it is integers, so the
// picture is one device's, byte for byte, however the samples are shared out (docs/decisions/025-pictures-by-ranks.md).
//
// A device draws with one where createCpuDevice() is given it; without, nothing is asked of it and nothing spent. Every
// function is called on the render thread, by all devices in the same order with as many elements, and waits for the
// others.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "renderer/device/cpu/kernels/kernels.hpp"

namespace scancast::cpu {

/// Who needs what was agreed on; elsewhere nobody looks at the elements afterwards.
enum class Receivers : std::uint8_t {
    Everybody,  ///< a later pass looks at it
    WhoShows,   ///< it is only shown
};

class PassReduction {
  public:
    virtual ~PassReduction() = default;
    /// A picture begins, of which everybody has drawn nothing yet. The result takes the place of `stop`: it is stopped
    /// within one of the functions below, for all devices within the same one, after some device's `stop` was. From
    /// then on nothing more is asked for that picture.
    virtual std::stop_token begin(std::stop_token stop) = 0;
    /// Exactly one device's pictures are looked at: it resolves pixels, runs the screen passes and has a frame in the end.
    virtual bool shows() const = 0;
    /// Each key becomes the smallest of all devices'. Most are emptyKey.
    virtual void least(std::span<Key> keys, Receivers to) = 0;
    /// Each number becomes the sum of all devices', for who shows. Most are 0.
    virtual void total(std::span<std::int64_t> sums) = 0;
    /// Each word becomes that of the one device where it is not 0, for who shows.
    virtual void join(std::span<std::uint32_t> words) = 0;
};

}  // namespace scancast::cpu
