// How likely each symbol is, learnt while symbols are decoded: the adaptive models of the arithmetic coder that LASzip uses
// (A. Said, "Introduction to Arithmetic Coding - Theory and Practice", HP Labs 2004, section 3; "LAZ Specification 1.4").
// The numbers must be those of the encoder, bit by bit. A model begins anew when it is first asked after reset(): of the
// hundreds that a point format has, a small chunk needs a few. Owned by an item's decoder.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

namespace scancast::laz {

class BitModel {
  public:
    static constexpr std::uint32_t shift = 13;

    void reset() { *this = BitModel{}; }
    std::uint32_t probabilityOfZero() const { return probabilityOfZero_; }
    void count(bool one) {
        if (!one) ++zeros_;
        if (--untilUpdate_ == 0) update();
    }

  private:
    void update() {
        count_ += cycle_;
        if (count_ > (1U << shift)) {
            count_ = (count_ + 1) >> 1;
            zeros_ = (zeros_ + 1) >> 1;
            if (zeros_ == count_) ++count_;
        }
        const std::uint32_t scale = 0x80000000U / count_;
        probabilityOfZero_ = (zeros_ * scale) >> (31 - shift);
        cycle_ = std::min<std::uint32_t>(64, (5 * cycle_) >> 2);
        untilUpdate_ = cycle_;
    }

    std::uint32_t zeros_ = 1, count_ = 2, probabilityOfZero_ = 1U << (shift - 1), cycle_ = 4,
                  untilUpdate_ = 4;
};

/// Symbols 0 … symbols - 1.
template <std::uint32_t symbols>
class SymbolModel {
  public:
    static constexpr std::uint32_t shift = 15;
    static constexpr std::uint32_t last = symbols - 1;

    void reset() { ready_ = false; }
    void prepare() {
        if (!ready_) [[unlikely]]
            begin();
    }
    /// Where the symbol begins, of 2^shift.
    std::uint32_t from(std::uint32_t symbol) const { return from_[symbol]; }
    /// The symbol in whose part `place` lies; places from 2^shift on (by less than 64) are the last one's.
    std::uint32_t find(std::uint32_t place) const {
        if constexpr (tableSize > 0) {
            std::uint32_t symbol = table_[place >> tableShift];
            while (from_[symbol + 1] <= place) ++symbol;
            return symbol;
        }
        std::uint32_t low = 0, high = symbols;
        while (high > low + 1) {
            const std::uint32_t middle = (low + high) >> 1;
            if (from_[middle] > place)
                high = middle;
            else
                low = middle;
        }
        return low;
    }
    void count(std::uint32_t symbol) {
        ++counts_[symbol];
        if (--untilUpdate_ == 0) [[unlikely]]
            update();
    }

  private:
    // Slots of at least 2^7 places: what lies behind 2^shift is less than one more.
    static constexpr std::uint32_t tableBits() {
        std::uint32_t bits = 3;
        while (bits < 8 && symbols > (1U << bits)) ++bits;
        return bits;
    }
    static_assert(symbols >= 2 && symbols <= 1024);
    using Symbol = std::conditional_t<symbols <= 256, std::uint8_t, std::uint16_t>;
    static constexpr std::uint32_t tableSize = symbols > 16 ? 1U << tableBits() : 0;
    static constexpr std::uint32_t tableShift = shift - tableBits();

    void begin() {
        ready_ = true;
        counts_.fill(1);
        total_ = 0;
        cycle_ = symbols;
        update();
        untilUpdate_ = cycle_ = (symbols + 6) >> 1;
    }

    void update() {
        total_ += cycle_;
        if (total_ > (1U << shift)) {
            total_ = 0;
            for (auto& count : counts_) total_ += count = static_cast<std::uint16_t>((count + 1U) >> 1);
        }
        const std::uint32_t scale = 0x80000000U / total_;
        std::uint32_t sum = 0, slot = 0;
        for (std::uint32_t symbol = 0; symbol < symbols; ++symbol) {
            from_[symbol] = static_cast<std::uint16_t>((scale * sum) >> (31 - shift));
            sum += counts_[symbol];
            if constexpr (tableSize > 0)
                for (const std::uint32_t end = from_[symbol] >> tableShift; slot < end;)
                    table_[++slot] = static_cast<Symbol>(symbol - 1);
        }
        from_[symbols] = 0xffff;
        if constexpr (tableSize > 0) {
            table_[0] = 0;
            while (slot <= tableSize) table_[++slot] = static_cast<Symbol>(last);
        }
        cycle_ = std::min((5 * cycle_) >> 2, (symbols + 6) << 3);
        untilUpdate_ = cycle_;
    }

    bool ready_ = false;
    std::uint32_t total_ = 0, cycle_ = 0, untilUpdate_ = 0;
    std::array<std::uint16_t, symbols + 1> from_;  // and an end that no place reaches
    std::array<std::uint16_t, symbols> counts_;
    // The symbol that the slot begins with, or the one before. Without a table: unused.
    std::array<Symbol, tableSize + 2> table_;
};

template <std::uint32_t symbols, std::size_t count>
void resetAll(std::array<SymbolModel<symbols>, count>& models) {
    for (auto& model : models) model.reset();
}

}  // namespace scancast::laz
