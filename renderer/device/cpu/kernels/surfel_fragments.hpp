// One surfel's fragments: a row of pixels at a time, reduced as the pass says. Part of kernels.cpp.
#pragma once

#include "renderer/device/cpu/kernels/creases.hpp"
#include "renderer/device/cpu/kernels/formulas.hpp"
#include "renderer/device/cpu/kernels/sums.hpp"
#include "renderer/device/cpu/kernels/surfaces.hpp"
#include "renderer/device/cpu/kernels/surfel_block.hpp"

namespace scancast::cpu {
namespace {

/// `extra`: Nearest carries colours in its keys; Sum adds normals. `rows`: how many the lanes are pixels of, one or two.
template <Shape shape, Reduction reduction, bool perspective, bool extra, int lanes, int rows>
class SurfelFragments {
    using F = Float<lanes>;
    using I = Int<lanes>;
    static constexpr bool disc = shape == Shape::Disc;
    static constexpr bool sums = reduction == Reduction::Sum;
    static constexpr bool nearest = reduction == Reduction::Nearest;
    static constexpr bool cells = reduction == Reduction::Cell;
    static constexpr bool turning = sums && extra && !disc;  ///< normals may turn across the surfel

  public:
    static constexpr int columns = lanes / rows;

    SurfelFragments(const SplatPass& pass, const Block& b, const Surfels& s, int i, const KeyTile& tile)
        : tile_(tile),
          addends_(sums ? b.color[i] : 0),
          x_(b.x[i]),
          y_(b.y[i]),
          sy_(s.sy[i]),
          ty_(s.ty[i]),
          near_(pass.near),
          surfaces_(pass.payload == SplatPayload::Surface),
          centerRow_(static_cast<std::int32_t>(__builtin_floorf(b.y[i]))),
          centerColumn_(static_cast<std::int32_t>(__builtin_floorf(b.x[i]))) {
        depth_ = F{} + b.depth[i];
        sx_ = F{} + s.sx[i];
        slopeX_ = F{} + s.slopeX[i];
        if constexpr (disc) {
            tx_ = F{} + s.tx[i];
        } else {
            slopeY_ = s.slopeY[i];
            low_ = F{} + s.low[i];
            high_ = F{} + s.high[i];
        }
        if constexpr (disc ? cells : sums) radius_ = F{} + s.radius[i];
        if constexpr (sums && !disc) peak_ = F{} + s.peak[i];
        if constexpr (reduction != Reduction::Nearest) tolerance_ = F{} + s.tolerance[i];
        front_ = F{} + s.front[i];
        if constexpr (nearest && extra) distance_ = F{} + s.distance[i];
        payload_ =
            I{} + (!sums && pass.payload == SplatPayload::Surface ? s.surface[i]
                                                                  : static_cast<std::int32_t>(b.color[i]));
        if constexpr (!nearest) {
            unitsPerPx_ = 1.0f / pass.pixelsPerUnit;
            surface_ = {s.surface[i], s.anySide[i] != 0};
        }
        if (disc && nearest && surfaces_) stepsPerPx_ = offsetSteps / s.half[i];
        if constexpr (disc && !nearest) sheet_ = F{} + s.sheet[i];
        if constexpr (cells) {
            pixelsPerUnit_ = pass.pixelsPerUnit;
            axisX_ = pass.centerX;
            axisY_ = pass.centerY;
            here_ = {s.normalX[i], s.normalY[i], s.normalZ[i], F{}, F{}, s.half[i]};
        }
        if constexpr (sums && extra) addends_.setNormal(s.normalX[i], s.normalY[i], s.normalZ[i]);
        if constexpr (turning) setBend(s, i);
    }

    /// Starts rows of lanes at this column of the picture; those beyond `last` and `lastRow` are left alone by sums.
    void startColumns(std::int32_t column, std::int32_t last, std::int32_t lastRow) {
        lastRow_ = lastRow;
        const F numbers = laneNumbers<lanes>() - rowNumbers() * static_cast<float>(columns);
        middle_ = static_cast<float>(column) + 0.5f + numbers;
        dx_ = middle_ - x_;
        if (disc && nearest && surfaces_) column_ = payload_ | offsetBits(-dx_ * stepsPerPx_) << 24;
        const I places = __builtin_convertvector(numbers, I) + column;
        center_ = places == centerColumn_;
        if constexpr (sums) inside_ = places <= last;
        sdx_ = sx_ * dx_;
        if constexpr (disc) {
            tdx_ = tx_ * dx_;
        } else {
            tdx_ = slopeX_ * dx_;
            tdx_ = (perspective ? F{} + 1.0f : depth_) + tdx_;
        }
        if constexpr (turning)
            for (int a = 0; a < 3 && bent_; ++a) rowNormal_[a] = normal_[a] + right_[a] * dx_;
    }

    /// The lanes of a row, or of two, at this offset from the tile's pixel (0, 0).
    [[gnu::always_inline]] void draw(std::int64_t offset, std::int32_t row) {
        const F visible = loadOrders<lanes>((nearest ? tile_.keys : tile_.visible) + offset, second());
        // Hidden: nothing of it needs to be computed. Without a depth, which is not a number, comparisons do
        // not hold: there the nearest pass draws, and the others do not.
        if (!anyOf<lanes>(nearest ? ~(visible < front_) : visible >= front_)) return;
        const F y = (static_cast<float>(row) + rowNumbers()) + 0.5f, dy = y - y_;
        const F s = sdx_ + sy_ * dy;
        F t, c;
        if constexpr (disc) {
            t = tdx_ + ty_ * dy;
            c = slopeX_ * t + (perspective ? F{} + 1.0f : depth_);
        } else {
            t = ty_ * dy;
            const F on = tdx_ + slopeY_ * dy;
            const F above = on > low_ ? on : low_;
            c = above < high_ ? above : high_;
        }
        const F square = s * s + t * t;
        I covered = square <= (disc && perspective ? c * c : F{} + 1.0f);
        const I center = center_ & (__builtin_convertvector(rowNumbers(), I) + row == centerRow_);
        // The centre's pixel is covered anyway, at the centre's depth.
        covered |= center;
        c = center ? (perspective ? F{} + 1.0f : depth_) : c;
        covered &= perspective ? depth_ >= near_ * c : c >= F{} + near_;
        if constexpr (rows > 1) covered &= __builtin_convertvector(rowNumbers(), I) + row <= lastRow_;
        reduce(offset, y, visible, square, c, covered);
    }

    bool full() const { return sums && anyOf<lanes>(full_); }

  private:
    /// Of each lane, counted from the first.
    static F rowNumbers() {
        if constexpr (rows == 2) return F{0, 0, 0, 0, 1, 1, 1, 1};
        return F{};
    }
    /// From the first half of the lanes to the second, in keys and sums.
    std::int64_t second() const { return rows == 2 ? tile_.stride : sameRow<lanes>; }

    /// `c`: depth = d / c in perspective, else the depth itself; `y`: of the pixels' centres.
    [[gnu::always_inline]] void reduce(std::int64_t offset, F y, F visible, F square, F c, I covered) {
        if constexpr (sums && disc) covered &= notBehind(visible, c, tolerance_);
        if (tile_.silhouette != nullptr) {
            const F border = loadOrders<lanes>(tile_.silhouette + offset, second());
            // Where there is none, it is not a number, and no comparison holds.
            covered &= ~(perspective ? depth_ > border * c : c > border);
        }
        if constexpr (sums) {
            covered &= inside_;
            add(offset, y - y_, visible, square, c, covered);
        } else {
            F order;
            I below = payload(y - y_);
            if constexpr (cells) {
                order = placeOnDisc(square, c) * radius_;
                seeCreases(offset, y, visible, c, covered, order, below);
            } else {
                order = depthOf(c);
            }
            const F positive = order > 1.17549435e-38f ? order : F{} + 1.17549435e-38f;
            const I bits = covered ? reinterpret_cast<I>(positive) : I{} + emptyOrder;
            if constexpr (rows == 2) {
                storeNearest(tile_.keys + offset, tile_.keys + offset + second(), bits, below);
            } else {
                storeNearest(tile_.keys + offset, bits, below);
            }
        }
    }

    /// Where what is visible faces another way: which of the two is the surface.
    void seeCreases(std::int64_t offset, F y, F visible, F c, I& covered, F& order, I& below) {
        const I surface = loadPayloads<lanes>(tile_.visible + offset, second());
        const I different = surface_.agreement(surface) < sameSide;
        // What is visible is one of them, so none lies before it.
        covered &= notBehind(visible, c, different ? tolerance_ : sheet_);
        const I other = covered & different;
        if (!anyOf<lanes>(other)) return;
        here_.right = -dx_;
        here_.up = y - y_;
        const F gap = (depthOf(c) - visible) * pixelsPerUnit_ / (perspective ? visible : F{} + 1.0f);
        const F u = perspective ? (middle_ - axisX_) * unitsPerPx_ : F{};
        const F v = perspective ? (axisY_ - y) * unitsPerPx_ : F{};
        const Verdict<lanes> verdict = meet<lanes>(surface, here_, gap, u, v);
        covered &= ~(other & verdict.shunned);
        order = other & verdict.wins ? order * creasePriority : order;
        if (surfaces_) below |= other & toleranceCode(gap) << 24;
    }

    /// Adds what belongs to the surface that is visible there, as that surface itself says.
    [[gnu::always_inline]] void add(std::int64_t offset, F dy, F visible, F square, F c, I covered) {
        if (disc && !anyOf<lanes>(covered)) return;
        const I surface = loadPayloads<lanes>(tile_.surfaces + offset, second());
        F share = F{} + 1.0f;
        if constexpr (disc) {
            // No more than the angle between their normals leaves of it.
            share = __builtin_convertvector(surface_.agreement(surface), F) * blendPerStep - 0.5f;
            covered &= share > 0.0f;
            share = share < 1.0f ? share : F{} + 1.0f;
            covered &= nearVisible(behind(visible, surface), c, sheet_);
        } else {
            covered &= within(visible, tolerance_, c);
            // Most lie so near that it does not matter which way they face.
            const I beyond = covered & ~within(visible, leastReach(surface, tolerance_), c);
            if (anyOf<lanes>(beyond)) {
                const F reach = reachBehind(surface, surface_.agreement(surface), tolerance_, radius_);
                share = beyond & ~within(visible, reach, c) ? F{} + hiddenShare : share;
            }
        }
        if (!anyOf<lanes>(covered)) return;
        if constexpr (turning) {
            if (bent_) {
                addends_.x = quantiseNormal<lanes>(rowNormal_[0] + down_[0] * dy);
                addends_.y = quantiseNormal<lanes>(rowNormal_[1] + down_[1] * dy);
                addends_.z = quantiseNormal<lanes>(rowNormal_[2] + down_[2] * dy);
            }
        }
        const I whole = quantiseWeight<lanes>(weight(square, c) * share, covered);
        if (extra && surface_.mayTurn) {
            const I turned = surface_.turned(surface);
            addFragments<lanes, extra, true>(tile_, offset, whole, addends_, turned, full_, second());
        } else {
            addFragments<lanes, extra, false>(tile_, offset, whole, addends_, I{}, full_, second());
        }
    }

    void setBend(const Surfels& s, int i) {
        bent_ = s.bends && s.bent[i] != 0;
        if (!bent_) return;
        const float normal[3] = {s.normalX[i], s.normalY[i], s.normalZ[i]};
        for (int a = 0; a < 3; ++a) {
            normal_[a] = normal[a];
            right_[a] = s.bendRight[a][i];
            down_[a] = s.bendDown[a][i];
        }
    }

    F depthOf(F c) const { return perspective ? depth_ / c : c; }

    /// Whether a fragment lies at most so many px behind what is visible.
    I within(F visible, F px, F c) const {
        const F units = px * unitsPerPx_;
        return perspective ? depth_ <= (visible + visible * units) * c : c <= visible + units;
    }

    /// The depth of a cell's surface, by what is visible and its payload.
    F behind(F visible, I surface) const {
        const F units = toleranceOf(surface) * unitsPerPx_;
        return perspective ? visible + visible * units : visible + units;
    }

    /// Whether a fragment lies no further behind what is visible.
    I notBehind(F visible, F c, F tolerance) const {
        const F high = visible + tolerance;
        return perspective ? depth_ <= high * c : c <= high;
    }

    /// Whether a fragment lies so near to what is visible.
    I nearVisible(F visible, F c, F tolerance) const {
        const F low = visible - tolerance, high = visible + tolerance;
        if constexpr (perspective) return (depth_ >= low * c) & (depth_ <= high * c);
        return (c >= low) & (c <= high);
    }

    /// Distance from the centre in radii; at most 1, also in the centre's pixel.
    F placeOnDisc(F square, F c) const {
        const F root = squareRoot<lanes>(square);
        const F place = perspective ? root / c : root;
        return place < 1.0f ? place : F{} + 1.0f;
    }

    F weight(F square, F c) const {
        if constexpr (disc) {
            const F t = placeOnDisc(square, c);
            return 1.0f - (t * t) * (3.0f - 2.0f * t);
        } else {
            return peak_ * bell(smaller(square, all(1.0f)));
        }
    }

    /// Where a lane is not covered it means nothing, but it must stay an integer.
    I payload(F dy) const {
        if constexpr (!nearest) {
            return payload_;
        } else if constexpr (!extra) {
            if constexpr (!disc) return payload_;
            return surfaces_ ? column_ | offsetBits(dy * stepsPerPx_) << 28 : payload_;
        } else {
            const F d = (dx_ * dx_ + dy * dy) * distance_;
            const F bounded = d < 255.0f ? d : F{} + 255.0f;
            return (__builtin_convertvector(bounded, I) << 24) | payload_;
        }
    }

    const KeyTile tile_;
    Addends<lanes> addends_;
    F depth_, sx_, tx_, slopeX_, low_, high_, radius_, peak_, tolerance_, front_, distance_, sheet_;
    F middle_, dx_, sdx_, tdx_;
    I payload_, column_, center_, inside_, full_{};
    OfSurface<lanes> surface_;
    F rowNormal_[3];
    float normal_[3] = {}, right_[3] = {}, down_[3] = {};
    bool bent_ = false;
    DiscThere<lanes> here_;
    float x_, y_, sy_, ty_, slopeY_ = 0, near_, unitsPerPx_ = 0, pixelsPerUnit_ = 0;
    float stepsPerPx_ = 0, axisX_ = 0, axisY_ = 0;
    bool surfaces_;
    std::int32_t centerRow_, centerColumn_, lastRow_ = 0;
};

}  // namespace
}  // namespace scancast::cpu
