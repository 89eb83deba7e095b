// The end of a layer that was drawn together with other devices: pixels of each device's rows of the screen go to who shows them, or
// to everybody. What is background does not travel. (Their beginning: layer_together.cpp.)
#include <algorithm>
#include <cstring>
#include <limits>

#include "renderer/device/cpu/layer.hpp"

namespace scancast::cpu {

Planes Layer::own(const Planes& planes) const {
    const Rows seen = seenBy(together_->reduction->number());
    Planes part = planes;
    part.area.y0 = planes.area.y0 + seen.y0;
    part.area.y1 = planes.area.y0 + seen.y1;
    const std::ptrdiff_t at = std::ptrdiff_t{seen.y0} * planes.area.width();
    part.rgba += at;
    if (part.depth != nullptr) part.depth += at;
    if (part.normals != nullptr) part.normals += at;
    return part;
}

void Layer::collect(const Planes& planes, Receivers to) {
    if (workers_.stopped()) return;
    PassReduction& reduction = *together_->reduction;
    PackedSpans& packed = together_->packed;
    const std::int32_t width = planes.area.width(), first = planes.area.y0 - area_.y0;
    const Rows whole{0, planes.area.height()};
    const auto rowsIn = [&](std::uint32_t device) {
        const Rows rows = rowsOf(device);
        return Rows{rows.y0 - first, rows.y1 - first}.intersect(whole);
    };
    const std::uint32_t number = reduction.number();
    const bool everybody = to == Receivers::Everybody;
    const bool sends = everybody || !reduction.shows(), gets = everybody || reduction.shows();
    constexpr float far = std::numeric_limits<float>::infinity();
    // work(plane, what it has where nothing is), each as of 32 bits.
    const auto inEach = [&](std::int32_t y, const auto& work) {
        const std::ptrdiff_t row = std::ptrdiff_t{y} * width;
        work(planes.rgba + row, background_[static_cast<std::size_t>(y + first)]);
        if (planes.depth != nullptr) work(planes.depth + row, far);
        if (planes.normals != nullptr) work(planes.normals + row, 0u);
    };
    const std::size_t count = 1 + (planes.depth != nullptr ? 1 : 0) + (planes.normals != nullptr ? 1 : 0);
    const Rows own = rowsIn(number);
    packed.occupied.begin(width, whole);
    std::uint32_t* out = nullptr;
    const auto overRows = [&](const Rows& rows, const auto& work) {
        workers_.overRows(rows.count(), [&](int y0, int y1) {
            for (int y = rows.y0 + y0; y < rows.y0 + y1; ++y) work(y);
        });
    };
    if (sends) {
        overRows(own, [&](std::int32_t y) {
            inEach(y, [&](const auto* pixels, auto nothing) {
                packed.occupied.mark(y, 0, width, [&](std::int32_t x) { return pixels[x] != nothing; });
            });
        });
        packed.occupied.settle();
        out = packed.room<std::uint32_t>(packed.occupied.before(whole.y1) * count * spanLength);
        overRows(own, [&](std::int32_t y) {
            packed.occupied.inRow(y, 0, width, [&](std::int32_t x, std::int32_t n, std::size_t at) {
                std::uint32_t* span = out + at * count * spanLength;
                inEach(y, [&](const auto* pixels, auto) {
                    put(pixels + x, n, span);
                    span += spanLength;
                });
            });
        });
    } else {
        packed.occupied.settle();
    }
    packed.exchange(
        reduction, count * spanLength * sizeof(std::uint32_t),
        [&](std::uint32_t d) { return sends && (everybody || d == 0) ? own : Rows{}; },
        [&](std::uint32_t d) { return gets ? rowsIn(d) : Rows{}; },
        [&](std::uint32_t d, const OccupiedSpans& theirs, const std::byte* in) {
            overRows(rowsIn(d), [&](std::int32_t y) {
                inEach(y, [&](auto* pixels, auto nothing) { std::fill_n(pixels, width, nothing); });
                theirs.inRow(y, 0, width, [&](std::int32_t x, std::int32_t n, std::size_t at) {
                    const std::byte* span = in + at * count * spanLength * sizeof(std::uint32_t);
                    inEach(y, [&](auto* pixels, auto) {
                        std::memcpy(pixels + x, span, static_cast<std::size_t>(n) * sizeof(std::uint32_t));
                        span += spanLength * sizeof(std::uint32_t);
                    });
                });
            });
        });
}

}  // namespace scancast::cpu
