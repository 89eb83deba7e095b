// The other side of the arithmetic decoder, for tests: Said's encoder with carries, as LASzip has it, over the same models. A plain value.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "importers/laz/decoder/models.hpp"

namespace scancast::test {

class ArithmeticEncoder {
  public:
    template <std::uint32_t symbols>
    void symbol(laz::SymbolModel<symbols>& model, std::uint32_t symbol) {
        model.prepare();
        const std::uint32_t part = length_ >> laz::SymbolModel<symbols>::shift;
        const std::uint32_t from = model.from(symbol) * part;
        const std::uint32_t to = symbol == model.last ? length_ : model.from(symbol + 1) * part;
        add(from);
        length_ = to - from;
        renormalize();
        model.count(symbol);
    }
    void bit(laz::BitModel& model, bool one) {
        const std::uint32_t split = model.probabilityOfZero() * (length_ >> laz::BitModel::shift);
        if (one) add(split);
        length_ = one ? length_ - split : split;
        renormalize();
        model.count(one);
    }
    void bits(std::uint32_t count, std::uint32_t number) {
        if (count > 19) {
            bits(16, number & 0xffff);
            return bits(count - 16, number >> 16);
        }
        length_ >>= count;
        add(number * length_);
        renormalize();
    }
    /// The stream, which a decoder reads to its last byte and no further.
    std::vector<std::byte> finish() {
        const bool isLong = length_ > 2 * leastLength;
        add(isLong ? leastLength : leastLength >> 1);
        length_ = isLong ? leastLength >> 1 : leastLength >> 9;
        renormalize();
        bytes_.resize(bytes_.size() + (isLong ? 3 : 2));
        return std::move(bytes_);
    }

  private:
    static constexpr std::uint32_t leastLength = 1U << 24;

    void add(std::uint32_t number) {
        base_ += number;
        if (base_ >= number) return;
        std::size_t at = bytes_.size();
        while (bytes_[--at] == std::byte{0xff}) bytes_[at] = std::byte{0};
        bytes_[at] = static_cast<std::byte>(static_cast<std::uint8_t>(bytes_[at]) + 1);
    }
    void renormalize() {
        while (length_ < leastLength) {
            bytes_.push_back(static_cast<std::byte>(base_ >> 24));
            base_ <<= 8;
            length_ <<= 8;
        }
    }

    std::uint32_t base_ = 0, length_ = 0xffffffff;
    std::vector<std::byte> bytes_;
};

/// Integers of 32 bits by their differences from predictions.
class IntegerEncoder {
  public:
    explicit IntegerEncoder(std::size_t contexts) : sizes_(contexts) {}

    void encode(ArithmeticEncoder& encoder, std::int32_t prediction, std::int32_t number,
                std::size_t context = 0) {
        const auto difference = static_cast<std::int32_t>(static_cast<std::uint32_t>(number) -
                                                          static_cast<std::uint32_t>(prediction));
        // The least k with -(2^k - 1) <= difference <= 2^k.
        const std::uint32_t size = difference > 0 ? static_cast<std::uint32_t>(difference) - 1
                                                  : 0U - static_cast<std::uint32_t>(difference);
        size_ = static_cast<std::uint32_t>(std::bit_width(size));
        encoder.symbol(sizes_[context], size_);
        if (size_ == 0) return encoder.bit(one_, difference == 1);
        if (size_ == 32) return;
        const std::uint32_t place =
            static_cast<std::uint32_t>(difference) + (difference > 0 ? 0xffffffffU : (1U << size_) - 1);
        switch (size_) {
            case 1:
                return encoder.symbol(two_, place);
            case 2:
                return encoder.symbol(four_, place);
            case 3:
                return encoder.symbol(eight_, place);
            case 4:
                return encoder.symbol(sixteen_, place);
            case 5:
                return encoder.symbol(thirtyTwo_, place);
            case 6:
                return encoder.symbol(sixtyFour_, place);
            case 7:
                return encoder.symbol(oneHundredAndTwentyEight_, place);
            case 8:
                return encoder.symbol(high_[0], place);
            default:
                encoder.symbol(high_[size_ - 8], place >> (size_ - 8));
                encoder.bits(size_ - 8, place & ((1U << (size_ - 8)) - 1));
        }
    }
    std::uint32_t lastSize() const { return size_; }

  private:
    std::uint32_t size_ = 0;
    std::vector<laz::SymbolModel<33>> sizes_;
    laz::BitModel one_;
    laz::SymbolModel<2> two_;
    laz::SymbolModel<4> four_;
    laz::SymbolModel<8> eight_;
    laz::SymbolModel<16> sixteen_;
    laz::SymbolModel<32> thirtyTwo_;
    laz::SymbolModel<64> sixtyFour_;
    laz::SymbolModel<128> oneHundredAndTwentyEight_;
    std::array<laz::SymbolModel<256>, 24> high_;
};

}  // namespace scancast::test
