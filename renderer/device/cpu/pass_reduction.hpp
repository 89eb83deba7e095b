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
#include <vector>

#include "renderer/device/cpu/kernels/kernels.hpp"

namespace scancast::cpu {

/// Who needs what was agreed on; elsewhere nobody looks at the elements afterwards.
enum class Receivers : std::uint8_t {
    Everybody,  ///< a later pass looks at it
    WhoShows,   ///< it is only shown
};

/// Planes of sums: Σw, three of colours, and three of normals or none; where the first is 0, so are all. In 32 bits as long as they
/// fit: colours' without a sign, normals' with one.
struct SumPlanes {
    std::size_t count = 0, pixels = 0;
    bool isWide = false;
    std::vector<std::int32_t> narrow;  ///< or, where that is so,
    std::vector<std::int64_t> wide;    ///< one plane after the other; they grow to the largest and stay

    std::int64_t at(std::size_t place) const {
        if (isWide) return wide[place];
        const std::int32_t sum = narrow[place];
        return place < colorPlanes * pixels ? std::int64_t{static_cast<std::uint32_t>(sum)}
                                            : std::int64_t{sum};
    }
    /// Makes room, of what they are in.
    void grow() {
        if (isWide && wide.size() < count * pixels) wide.resize(count * pixels);
        if (!isWide && narrow.size() < count * pixels) narrow.resize(count * pixels);
    }
    void widen() {
        if (isWide) return;
        if (wide.size() < count * pixels) wide.resize(count * pixels);
        for (std::size_t i = 0; i < count * pixels; ++i) wide[i] = at(i);
        isWide = true;
    }
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
    /// Each sum becomes that of all devices', for who shows; wide, if it must be.
    virtual void total(SumPlanes& sums) = 0;
    /// Each word becomes that of the one device where it is not 0, for who shows.
    virtual void join(std::span<std::uint32_t> words) = 0;
};

}  // namespace scancast::cpu
