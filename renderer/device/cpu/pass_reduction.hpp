// What devices that draw one picture together - each a share of the samples - tell each other between passes: which parts of
// planes they have anything in, and those parts, to the device whose rows of the screen they lie in. That one takes the
// smallest keys, adds sums, joins pixels. All of it is integers, so the picture is one device's, byte for byte, however
// the samples are shared out (docs/decisions/025-pictures-by-ranks.md).
//
// A device draws with one where createCpuDevice() is given it; without, nothing is asked of it and nothing spent. Every
// function is called on the render thread, by all devices in the same order, and waits for the others. What travels is
// packed before (packed_spans.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "protocol/error.hpp"
#include "renderer/device/pause.hpp"

namespace scancast::cpu {

/// A part of some planes on its way to another device: of its spans (occupied_spans.hpp) which are there, a bit each, and
/// those. Without marks there is nothing to say.
struct SentSpans {
    std::span<const std::uint64_t> marks;
    std::span<const std::byte> spans;
};

/// The same at the other end, which knows how many marks there are.
struct ReceivedSpans {
    std::span<std::uint64_t> marks;
    std::span<const std::byte> spans;  ///< valid while its arrival is told
};

class PassReduction {
  public:
    using Arrived = std::function<void(std::uint32_t device)>;

    virtual ~PassReduction() = default;
    virtual std::uint32_t devices() const = 0;
    /// Which of them this is.
    virtual std::uint32_t number() const = 0;
    /// Exactly one device's pictures are looked at.
    bool shows() const { return number() == 0; }
    /// A picture begins, of which everybody has drawn nothing yet. The result takes the place of `stop`: it is stopped
    /// within agree(), for all devices within the same call, after some device's `stop` was; from then on nothing more is
    /// asked for that picture. Within agree(), too, who shows may let others in by `pause` (null: never): then all draw
    /// other pictures meanwhile.
    virtual std::stop_token begin(std::stop_token stop, const Pause* pause) = 0;
    /// After each pass: each word becomes all devices', joined by `or`. False: the picture is no longer wanted.
    virtual bool agree(std::span<std::uint64_t> words) = 0;
    /// sent[d] goes to device d, received[d] is what d sends here; a span has so many bytes, a multiple of 64. `arrived` is
    /// called once for each that has marks, in any order.
    virtual void exchange(std::span<const SentSpans> sent, std::span<ReceivedSpans> received,
                          std::size_t bytesOfSpan, const Arrived& arrived) = 0;
    /// After begin(): this device cannot draw its share, and the others are not to wait for it.
    virtual void giveUp(const Error& error) = 0;
};

}  // namespace scancast::cpu
