// Where in some rows of planes there is anything at all: what devices that draw together tell each other is mostly background,
// and that need not travel. Spans of 16 pixels of a row, a bit for each; a row begins with a word of its own. Marked and read by
// several threads at once, everything else on the render thread. Part of packed_spans.hpp's and layer_together.cpp's work.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scancast::cpu {

/// [y0, y1) of a plane.
struct Rows {
    std::int32_t y0 = 0, y1 = 0;
    std::int32_t count() const { return std::max(0, y1 - y0); }
    bool has(std::int32_t y) const { return y >= y0 && y < y1; }
    Rows intersect(const Rows& o) const { return {std::max(y0, o.y0), std::min(y1, o.y1)}; }
};

class OccupiedSpans {
  public:
    static constexpr std::int32_t length = 16;

    /// Nothing is occupied.
    void begin(std::int32_t width, const Rows& rows) {
        width_ = width;
        rows_ = rows;
        perRow_ = static_cast<std::size_t>((width + 64 * length - 1) / (64 * length));
        words_.assign(perRow_ * static_cast<std::size_t>(rows.count()), 0);
    }
    const Rows& rows() const { return rows_; }
    std::int32_t width() const { return width_; }
    /// Of the row's pixels [x0, x1), those spans where isThere(x) for any x. x0 is a span's first pixel.
    template <class IsThere>
    void mark(std::int32_t row, std::int32_t x0, std::int32_t x1, const IsThere& isThere) {
        for (std::int32_t x = x0; x < x1;) {
            const std::size_t at = word(row, x);
            const std::int32_t end = std::min(x1, (x / (64 * length) + 1) * (64 * length));
            std::uint64_t bits = 0;
            for (; x < end; x += length) {
                bool any = false;
                for (std::int32_t i = x; i < std::min(x + length, end); ++i) any |= isThere(i);
                bits |= std::uint64_t{any} << (x / length % 64);
            }
            // Tiles side by side share words, and no spans.
            if (bits != 0) std::atomic_ref(words_[at]).fetch_or(bits, std::memory_order_relaxed);
        }
    }
    /// What is occupied in `other`, which lies within these rows, is so here, too.
    void add(const OccupiedSpans& other) {
        std::uint64_t* to = words(other.rows_).data();
        for (const std::uint64_t from : other.words_) *to++ |= from;
    }
    std::span<std::uint64_t> words() { return words_; }
    std::span<std::uint64_t> words(const Rows& rows) {
        return std::span(words_).subspan(first(rows.y0), static_cast<std::size_t>(rows.count()) * perRow_);
    }
    /// Of one row.
    std::int32_t occupied(std::int32_t row) const {
        std::int32_t spans = 0;
        for (std::size_t i = first(row); i < first(row + 1); ++i) spans += std::popcount(words_[i]);
        return spans;
    }

    /// What is marked stays so; numbers the spans, row by row.
    void settle() {
        before_.resize(words_.size() + 1);
        std::uint32_t spans = 0;
        for (std::size_t i = 0; i < words_.size(); ++i) {
            before_[i] = spans;
            spans += static_cast<std::uint32_t>(std::popcount(words_[i]));
        }
        before_.back() = spans;
    }
    /// Occupied spans before a row; after all of them: how many there are.
    std::size_t before(std::int32_t row) const { return before_[first(row)]; }
    /// work(x, count, number): the occupied spans of the row's pixels [x0, x1), each with its number. x0 is a span's first pixel.
    template <class Work>
    void inRow(std::int32_t row, std::int32_t x0, std::int32_t x1, const Work& work) const {
        for (std::int32_t x = x0; x < x1;) {
            const std::size_t at = word(row, x);
            const std::int32_t left = x / (64 * length) * (64 * length);
            const std::int32_t end = std::min(x1, left + 64 * length);
            const int skipped = (x - left) / length, spans = (end - x + length - 1) / length;
            std::uint64_t bits = words_[at] >> skipped;
            if (spans < 64) bits &= (std::uint64_t{1} << spans) - 1;
            std::size_t number =
                before_[at] +
                static_cast<std::size_t>(std::popcount(words_[at] & ((std::uint64_t{1} << skipped) - 1)));
            for (; bits != 0; bits &= bits - 1) {
                const std::int32_t first = x + std::countr_zero(bits) * length;
                work(first, std::min(length, end - first), number++);
            }
            x = end;
        }
    }

  private:
    std::size_t first(std::int32_t row) const { return static_cast<std::size_t>(row - rows_.y0) * perRow_; }
    std::size_t word(std::int32_t row, std::int32_t x) const {
        return first(row) + static_cast<std::size_t>(x / (64 * length));
    }

    std::int32_t width_ = 0;
    Rows rows_;
    std::size_t perRow_ = 0;
    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> before_;  ///< occupied spans before each word
};

}  // namespace scancast::cpu
