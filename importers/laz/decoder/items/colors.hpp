// Colours of 16 bits, as bytes that are predicted from those of the record before and from each other: RGB12, RGB14, RGBNIR14.
// Owned by an item's decoder.
#pragma once

#include <array>

#include "importers/laz/decoder/integer_decoder.hpp"
#include "importers/laz/decoder/items/item_decoder.hpp"

namespace scancast::laz {

/// Red, green, blue as version 2 of RGB12 and all of RGB14 have them.
class ColorDecoder {
  public:
    static constexpr std::size_t bytes = 6;

    void reset();
    /// `last`, in place, becomes the next.
    void decode(ArithmeticDecoder& decoder, std::byte* last);

  private:
    SymbolModel<128> changed_;
    std::array<SymbolModel<256>, 6> differences_;  // low and high bytes of red, green, blue
};

/// Near infrared.
class InfraredDecoder {
  public:
    static constexpr std::size_t bytes = 2;

    void reset();
    void decode(ArithmeticDecoder& decoder, std::byte* last);

  private:
    SymbolModel<4> changed_;
    std::array<SymbolModel<256>, 2> differences_;
};

class Rgb12V1 final : public ItemDecoder {
  public:
    explicit Rgb12V1(ArithmeticDecoder& decoder) : decoder_(decoder) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    ArithmeticDecoder& decoder_;
    std::array<std::byte, ColorDecoder::bytes> last_{};
    SymbolModel<64> changed_;
    IntegerDecoder<8> values_{6};
};

class Rgb12V2 final : public ItemDecoder {
  public:
    explicit Rgb12V2(ArithmeticDecoder& decoder) : decoder_(decoder) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    ArithmeticDecoder& decoder_;
    std::array<std::byte, ColorDecoder::bytes> last_{};
    ColorDecoder colors_;
};

}  // namespace scancast::laz
