// What devices that draw one picture together - each a share of the samples - agree on between splat passes: the
// smallest keys, sums of sums, and the pixels that only the owner of a sample can colour. All of it is integers, so the
// picture is one device's, byte for byte, however the samples are shared out (docs/decisions/025-pictures-by-ranks.md).
//
// A device draws with one where createCpuDevice() is given it; without, nothing is asked of it and nothing spent. Every
// function is called on the render thread, by all devices in the same order with as many elements, and waits for the
// others. What is empty everywhere is left out before (layer_together.cpp).
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "protocol/error.hpp"
#include "renderer/device/cpu/kernels/kernels.hpp"
#include "renderer/device/pause.hpp"

namespace scancast::cpu {

/// Who needs what was agreed on; elsewhere nobody looks at the elements afterwards.
enum class Receivers : std::uint8_t {
    Everybody,  ///< a later pass looks at it
    WhoShows,   ///< it is only shown
};

class PassReduction {
  public:
    virtual ~PassReduction() = default;
    virtual std::uint32_t devices() const = 0;
    /// Exactly one device's pictures are looked at: it resolves pixels, runs the screen passes and has a frame in the end.
    virtual bool shows() const = 0;
    /// A picture begins, of which everybody has drawn nothing yet. The result takes the place of `stop`: it is stopped
    /// within agree(), for all devices within the same call, after some device's `stop` was; from then on nothing more is
    /// asked for that picture. Within agree(), too, who shows may let others in by `pause` (null: never): then all draw
    /// other pictures meanwhile.
    virtual std::stop_token begin(std::stop_token stop, const Pause* pause) = 0;
    /// Before each of those below: each word becomes all devices', joined by `or`. False: the picture is no longer wanted.
    virtual bool agree(std::span<std::uint64_t> words) = 0;
    /// Each key becomes the smallest of all devices'.
    virtual void least(std::span<Key> keys, Receivers to) = 0;
    /// Each number becomes the sum of all devices', for who shows: they fit.
    virtual void add(std::span<std::int32_t> sums) = 0;
    virtual void add(std::span<std::int64_t> sums) = 0;
    /// After begin(): this device cannot draw its share, and the others are not to wait for it.
    virtual void giveUp(const Error& error) = 0;
    /// Each word becomes that of the one device where it is not 0, for who shows.
    virtual void join(std::span<std::uint32_t> words) = 0;
};

}  // namespace scancast::cpu
