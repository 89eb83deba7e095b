// Where in some planes there is anything at all, and such parts of them packed one behind the other: what devices that draw together
// agree on is mostly background, and that need not travel. Spans of 16 pixels of a row. Marked and read by several threads at once,
// everything else on the render thread. Part of layer_together.cpp's work.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scancast::cpu {

class OccupiedSpans {
  public:
    static constexpr std::int32_t length = 16;

    /// Of planes of this size nothing is occupied. `notes`: words of the caller's that are agreed on, too.
    void begin(std::int32_t width, std::int32_t height, std::size_t notes) {
        width_ = width;
        perRow_ = (width + length - 1) / length;
        marks_.assign(static_cast<std::size_t>(perRow_) * static_cast<std::size_t>(height), 0);
        words_.assign(notes + (marks_.size() + 63) / 64, 0);
        notes_ = notes;
    }
    /// Of the row's pixels [x0, x1), those spans where isThere(x) for any x.
    template <class IsThere>
    void mark(std::int32_t row, std::int32_t x0, std::int32_t x1, const IsThere& isThere) {
        for (std::int32_t x = x0; x < x1;) {
            const std::int32_t end = std::min((x / length + 1) * length, x1);
            bool any = false;
            for (std::int32_t i = x; i < end; ++i) any |= isThere(i);
            // Two tiles may share a span.
            if (any) std::atomic_ref(marks_[place(row, x)]).store(1, std::memory_order_relaxed);
            x = end;
        }
    }
    /// Notes, then the marks as bits: all devices' together are any's.
    std::span<std::uint64_t> words() {
        for (std::size_t i = 0; i < marks_.size(); ++i)
            words_[notes_ + i / 64] |= std::uint64_t{marks_[i] != 0} << i % 64;
        return words_;
    }
    std::uint64_t& note(std::size_t i) { return words_[i]; }

    /// The marks are now what words() has become. How many elements a packed plane has.
    std::size_t settle() {
        before_.clear();
        std::size_t spans = 0;
        for (std::size_t word = notes_; word < words_.size(); ++word) {
            before_.push_back(static_cast<std::uint32_t>(spans));
            spans += static_cast<std::size_t>(std::popcount(words_[word]));
        }
        return spans * length;
    }
    /// work(x, count, at): so many of the row's pixels [x0, x1) lie from `at` on in a packed plane. In pieces as long as they can be.
    template <class Work>
    void inRow(std::int32_t row, std::int32_t x0, std::int32_t x1, const Work& work) const {
        for (std::int32_t x = x0; x < x1;) {
            const std::int32_t end = std::min((x / length + 1) * length, x1);
            if (!isOccupied(place(row, x))) {
                x = end;
                continue;
            }
            const std::size_t at = packed(place(row, x)) + static_cast<std::size_t>(x % length);
            std::int32_t last = end;
            while (last < x1 && isOccupied(place(row, last))) last = std::min(last + length, x1);
            work(x, last - x, at);
            x = last;
        }
    }
    /// Some elements of packed planes are no pixels'.
    bool hasRemnants() const { return width_ % length != 0; }

  private:
    std::size_t place(std::int32_t row, std::int32_t x) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(perRow_) +
               static_cast<std::size_t>(x / length);
    }
    bool isOccupied(std::size_t i) const { return words_[notes_ + i / 64] >> i % 64 & 1; }
    std::size_t packed(std::size_t i) const {
        const std::uint64_t below = words_[notes_ + i / 64] & ((std::uint64_t{1} << i % 64) - 1);
        return (before_[i / 64] + static_cast<std::size_t>(std::popcount(below))) * length;
    }

    std::int32_t width_ = 0, perRow_ = 0;
    std::size_t notes_ = 0;
    std::vector<std::uint8_t> marks_;
    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> before_;  ///< occupied spans before each word
};

}  // namespace scancast::cpu
