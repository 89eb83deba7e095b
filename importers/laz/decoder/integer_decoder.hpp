// Integers of 8, 16 or 32 bits out of an arithmetic decoder, each as its difference from a prediction: first how many bits the
// difference has, k, by a model of the context; then which of the differences of that many bits ("LAZ Specification 1.4").
// Owned by an item's decoder.
#pragma once

#include <vector>

#include "importers/laz/decoder/arithmetic_decoder.hpp"

namespace scancast::laz {

template <std::uint32_t bits>
class IntegerDecoder {
  public:
    static_assert(bits == 8 || bits == 16 || bits == 32);

    explicit IntegerDecoder(std::size_t contexts = 1) : sizes_(contexts) {}

    void reset() {
        for (auto& model : sizes_) model.reset();
        one_.reset();
        two_.reset();
        four_.reset();
        eight_.reset();
        sixteen_.reset();
        thirtyTwo_.reset();
        sixtyFour_.reset();
        oneHundredAndTwentyEight_.reset();
        for (auto& model : high_) model.reset();
    }

    std::int32_t decode(ArithmeticDecoder& decoder, std::int32_t prediction, std::size_t context = 0) {
        const std::uint32_t sum =
            static_cast<std::uint32_t>(prediction) + difference(decoder, sizes_[context]);
        if constexpr (bits == 32) return static_cast<std::int32_t>(sum);
        return static_cast<std::int32_t>(sum & ((1U << (bits % 32)) - 1));
    }

    /// Bits of the last difference: how well the prediction was.
    std::uint32_t lastSize() const { return size_; }

  private:
    static constexpr std::uint32_t tableBits = 8;  // more are plain

    // Modulo 2^32.
    std::uint32_t difference(ArithmeticDecoder& decoder, SymbolModel<bits + 1>& sizes) {
        size_ = decoder.symbol(sizes);
        if (size_ == 0) return decoder.bit(one_) ? 1 : 0;
        if (size_ == 32) return 0x80000000U;
        const std::uint32_t index = place(decoder);
        return index >= 1U << (size_ - 1) ? index + 1 : index - ((1U << size_) - 1);
    }

    std::uint32_t place(ArithmeticDecoder& decoder) {
        switch (size_) {
            case 1:
                return decoder.symbol(two_);
            case 2:
                return decoder.symbol(four_);
            case 3:
                return decoder.symbol(eight_);
            case 4:
                return decoder.symbol(sixteen_);
            case 5:
                return decoder.symbol(thirtyTwo_);
            case 6:
                return decoder.symbol(sixtyFour_);
            case 7:
                return decoder.symbol(oneHundredAndTwentyEight_);
            case 8:
                return decoder.symbol(high_[0]);
            default: {
                const std::uint32_t plain = size_ - tableBits;
                const std::uint32_t high = decoder.symbol(high_[plain]);
                return high << plain | decoder.bits(plain);
            }
        }
    }

    std::uint32_t size_ = 0;
    std::vector<SymbolModel<bits + 1>> sizes_;
    BitModel one_;
    SymbolModel<2> two_;
    SymbolModel<4> four_;
    SymbolModel<8> eight_;
    SymbolModel<16> sixteen_;
    SymbolModel<32> thirtyTwo_;
    SymbolModel<64> sixtyFour_;
    SymbolModel<128> oneHundredAndTwentyEight_;
    std::array<SymbolModel<256>, bits == 32 ? 24 : bits == 16 ? 9 : 1> high_;  // of 8 bits and more
};

}  // namespace scancast::laz
