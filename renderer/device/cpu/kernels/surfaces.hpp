// What a sum has to know of what is visible, in the 32 bits of a key's payload (host/splat_numbers.hpp): packed by
// the nearest pass, and asked by the sum whether a fragment is of the same surface. docs/spec/passes.md §2.2. Part of
// kernels.cpp.
#pragma once

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

template <int lanes>
inline Int<lanes> toleranceCode(Float<lanes> px) {
    const Float<lanes> most = Float<lanes>{} + 4194304.0f,
                       least = Float<lanes>{} + 1.0f / (1 << -leastTolerance);
    const Float<lanes> below = px < most ? px : most;
    const Int<lanes> bits = reinterpret_cast<Int<lanes>>(below > least ? below : least);
    return (bits - static_cast<std::int32_t>(toleranceBase)) >> toleranceShift;
}

template <int lanes>
inline Float<lanes> toleranceOf(Int<lanes> surface) {
    return reinterpret_cast<Float<lanes>>(((surface >> (24 - toleranceShift)) & (255 << toleranceShift)) +
                                          static_cast<std::int32_t>(toleranceBase));
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

/// px behind what is visible that are of its surface, by what is visible and by the splat.
template <int lanes>
inline Float<lanes> bothReach(Int<lanes> visible, Float<lanes> tolerance) {
    const Float<lanes> there = toleranceOf<lanes>(visible);
    return there < tolerance ? there : tolerance;
}

/// The same where their normals agree least.
template <int lanes>
inline Float<lanes> leastReach(Int<lanes> visible, Float<lanes> tolerance) {
    return bothReach<lanes>(visible, tolerance) * leastAgreement;
}

/// The same by their normals, for a splat of half that size.
template <int lanes>
inline Float<lanes> reachBehind(Int<lanes> visible, const OfSurface<lanes>& splat, Float<lanes> tolerance,
                                Float<lanes> half) {
    using F = Float<lanes>;
    const F share = __builtin_convertvector(splat.agreement(visible), F) * agreementPerStep + 0.5f;
    const F most = share < 1.0f ? share : F{} + 1.0f;
    const F agreed =
        bothReach<lanes>(visible, tolerance) * (most > leastAgreement ? most : F{} + leastAgreement);
    // What is seen edge-on stands out of its surface by its own size.
    const F z = __builtin_convertvector((visible << 8) >> 24, F);
    const F edgeOn = 2.0f - (z < 0.0f ? -z : z) * edgePerStep;
    const F itself = half * (edgeOn < 1.0f ? edgeOn : F{} + 1.0f);
    return agreed > itself ? agreed : itself;
}

}  // namespace
}  // namespace scancast::cpu
