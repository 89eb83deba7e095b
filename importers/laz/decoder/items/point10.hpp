// POINT10, the point of formats 0 to 5: position, intensity, returns, class, scan angle, user data, source.
// Owned by a chunk's decoder.
#pragma once

#include <array>

#include "importers/laz/decoder/integer_decoder.hpp"
#include "importers/laz/decoder/items/item_decoder.hpp"
#include "importers/laz/decoder/items/median.hpp"

namespace scancast::laz {

/// Bytes that are predicted by the byte before: a model for each value of that.
struct Point10Bytes {
    using Models = std::array<SymbolModel<256>, 256>;

    void reset();
    /// The next value of `byte`.
    void decode(ArithmeticDecoder& decoder, Models& models, std::byte& byte);

    Models returns, classification, userData;
};

class Point10V1 final : public ItemDecoder {
  public:
    explicit Point10V1(ArithmeticDecoder& decoder) : decoder_(decoder) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    void decodeOthers(std::uint32_t changed, std::uint32_t size);

    ArithmeticDecoder& decoder_;
    std::array<std::byte, 20> last_{};
    std::array<std::int32_t, 3> xDifferences_{}, yDifferences_{};
    std::size_t turn_ = 0;
    IntegerDecoder<32> x_{1}, y_{20}, z_{20};
    IntegerDecoder<16> intensity_{1}, source_{1};
    IntegerDecoder<8> angle_{2};
    SymbolModel<64> changed_;
    Point10Bytes bytes_;
};

class Point10V2 final : public ItemDecoder {
  public:
    explicit Point10V2(ArithmeticDecoder& decoder) : decoder_(decoder) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    void decodeOthers(std::uint32_t changed, std::size_t context);

    ArithmeticDecoder& decoder_;
    std::array<std::byte, 20> last_{};
    std::array<std::pair<Median, Median>, 16> medians_{};  // of differences in x and y
    std::array<std::uint16_t, 16> intensities_{};
    std::array<std::int32_t, 8> heights_{};
    IntegerDecoder<32> x_{2}, y_{22}, z_{20};
    IntegerDecoder<16> intensity_{4}, source_{1};
    SymbolModel<64> changed_;
    std::array<SymbolModel<256>, 2> angles_;
    Point10Bytes bytes_;
};

}  // namespace scancast::laz
