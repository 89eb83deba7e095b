// Spans of planes packed one behind the other, and exchanged with the devices that draw the same picture: a span's planes lie side
// by side, so that what any rows have is one piece of memory. And how the screen's rows are divided among devices. Owned by a
// device's buffers; on its render thread. Place: layer_together.cpp → **packed spans** → pass_reduction.hpp.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <vector>

#include "renderer/device/cpu/occupied_spans.hpp"
#include "renderer/device/cpu/pass_reduction.hpp"

namespace scancast::cpu {

inline constexpr std::size_t spanLength = OccupiedSpans::length;

/// work(i): each of `count` elements of a span; mostly it is whole, and the compiler knows how long that is.
template <class Work>
void inSpan(std::int32_t count, const Work& work) {
    if (count == OccupiedSpans::length) {
        for (std::size_t i = 0; i < spanLength; ++i) work(i);
    } else {
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) work(i);
    }
}

/// A whole span of elements, of which `count` are pixels.
template <class T, class From>
void put(const From* from, std::int32_t count, T* to) {
    inSpan(count, [&](std::size_t i) { to[i] = std::bit_cast<T>(from[i]); });
    for (std::size_t i = static_cast<std::size_t>(count); i < spanLength; ++i) to[i] = T{};
}

/// Whose rows of the screen are whose: neighbours', so that passes that look around need little of others.
class Bands {
  public:
    bool empty() const { return ends_.empty(); }
    /// By `everybodys` spans - all of a layer's rows -, so that all have about as many pixels to finish.
    void divide(const OccupiedSpans& everybodys, std::int32_t width, std::uint32_t devices) {
        const std::int32_t rows = everybodys.rows().count();
        const auto work =
            [&](std::int32_t row) {  // something in it costs about four times as much as nothing
                return std::int64_t{3} * everybodys.occupied(row) + width / OccupiedSpans::length + 1;
            };
        std::int64_t all = 0, done = 0;
        for (std::int32_t y = 0; y < rows; ++y) all += work(y);
        ends_.clear();
        std::int32_t y = 0;
        for (std::int64_t device = 1; device < devices; ++device) {
            while (y < rows && done * devices < all * device) done += work(y++);
            ends_.push_back(y);
        }
        ends_.push_back(rows);
    }
    /// And `reach` rows around them, as far as there are rows.
    Rows of(std::uint32_t device, std::int32_t reach = 0) const {
        const std::int32_t y0 = device == 0 ? 0 : ends_[device - 1], y1 = ends_[device];
        if (y0 >= y1) return {y0, y0};
        return {std::max(0, y0 - reach), std::min(ends_.back(), y1 + reach)};
    }

  private:
    std::vector<std::int32_t> ends_;
};

class PackedSpans {
  public:
    /// Of the device's own planes: what it packs.
    OccupiedSpans occupied;

    /// For so many elements, which hold anything.
    template <class T>
    T* room(std::size_t elements) {
        if (size_ < elements * sizeof(T)) {
            bytes_.reset();
            bytes_ = std::make_unique_for_overwrite<std::byte[]>(elements * sizeof(T));
            size_ = elements * sizeof(T);
        }
        return reinterpret_cast<T*>(bytes_.get());
    }
    /// What is in room(), of the spans that are `occupied`: of rows to(device) to each device, and from each what it has of
    /// rows from(device); no rows: nothing, and nothing is said to oneself. take(device, their spans, them) for each.
    template <class To, class From, class Take>
    void exchange(PassReduction& reduction, std::size_t bytesOfSpan, const To& to, const From& from,
                  const Take& take) {
        const std::uint32_t devices = reduction.devices(), own = reduction.number();
        sent_.assign(devices, {});
        received_.assign(devices, {});
        theirs_.resize(devices);
        for (std::uint32_t d = 0; d < devices; ++d) {
            if (d == own) continue;
            const Rows out = to(d), in = from(d);
            if (out.count() > 0) {
                const std::size_t begin = occupied.before(out.y0), end = occupied.before(out.y1);
                sent_[d] = {occupied.words(out),
                            {bytes_.get() + begin * bytesOfSpan, (end - begin) * bytesOfSpan}};
            }
            theirs_[d].begin(occupied.width(), in);
            received_[d].marks = theirs_[d].words();
        }
        reduction.exchange(sent_, received_, bytesOfSpan, [&](std::uint32_t d) {
            theirs_[d].settle();
            take(d, theirs_[d], received_[d].spans.data());
        });
    }

  private:
    std::unique_ptr<std::byte[]> bytes_;
    std::size_t size_ = 0;
    std::vector<SentSpans> sent_;
    std::vector<ReceivedSpans> received_;
    std::vector<OccupiedSpans> theirs_;
};

}  // namespace scancast::cpu
