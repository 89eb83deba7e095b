// What a sum has to know of what is visible, in the 32 bits of a key's payload (formulas/constants.inl): packed by
// the nearest pass, and asked by the sum whether a fragment is of the same surface. docs/spec/passes.md §2.2. Part of
// kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/formulas.hpp"
#include "renderer/device/cpu/kernels/sums.hpp"
#include "renderer/device/cpu/kernels/view_normals.hpp"

namespace scancast::cpu {
namespace {

/// A vector's parts in signed bytes, the highest one 0; each part in [-1, 1].
inline IntW normalBytes(FloatW x, FloatW y, FloatW z) {
    const auto byte = [](FloatW v) {
        return toInt(v * normalStepsOfSurface + (v < 0.0f ? all(-0.5f) : all(0.5f))) & 255;
    };
    return byte(x) | byte(y) << 8 | byte(z) << 16;
}

/// Of a block's sprites: normals alone.
inline void spriteSurfaces(const ViewNormals& view, int padded, std::uint32_t* surfaces) {
    for (int i = 0; i < padded; i += wideLanes)
        store(surfaces + i,
              normalBytes(load<FloatW>(view.x + i), load<FloatW>(view.y + i), load<FloatW>(view.z + i)));
}

/// The same instead of their colours.
inline void setSurfaces(const SplatPass& pass, bool oriented, Block& b) {
    ViewNormals view;
    viewNormals(pass, oriented, b, view);
    spriteSurfaces(view, b.padded, b.color);
}

/// A splat as its fragments are compared with what is visible.
template <int lanes>
struct OfSurface {
    using I = Int<lanes>;
    I even, odd;           ///< of the normal's bytes, as pairs of 16 bits: x and z, y and 0
    bool mayTurn = false;  ///< its normal might as well point the other way

    OfSurface() = default;
    OfSurface(std::int32_t bytes, bool anySide) : mayTurn(anySide) {
        even = evens(I{} + (bytes & 0xffffff));
        odd = odds(I{} + (bytes & 0xffffff));
    }

    /// Of the two normals, times normalStepsOfSurface squared.
    I cosine(I visible) const {
        return smallProduct(evens(visible), even) + smallProduct(odds(visible), odd);
    }
    /// The same whichever way it points, if it may turn.
    I agreement(I visible) const {
        const I c = cosine(visible);
        return mayTurn ? (c < 0 ? -c : c) : c;
    }
    /// Where its normal has to be turned to point to the visible's side.
    I turned(I visible) const { return cosine(visible) < 0; }

  private:
    typedef short Shorts __attribute__((vector_size(4 * lanes)));
    static I evens(I bytes) { return reinterpret_cast<I>((reinterpret_cast<Shorts>(bytes) << 8) >> 8); }
    /// The highest byte is another's: of the visible it is multiplied by 0.
    static I odds(I bytes) { return reinterpret_cast<I>(reinterpret_cast<Shorts>(bytes) >> 8); }
};

/// px behind what is visible that are of its surface, where their normals agree least.
inline FloatW leastReach(IntW visible, FloatW tolerance) {
    return bothReach(visible, tolerance) * leastAgreement;
}

}  // namespace
}  // namespace scancast::cpu
