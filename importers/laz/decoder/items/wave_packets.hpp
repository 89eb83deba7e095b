// Where a point's waveform is: WAVEPACKET13 and WAVEPACKET14. A number of the descriptor, a byte; then offset (64 bits), size (32), and four
// floats, as their bits. Owned by an item's decoder.
#pragma once

#include <array>

#include "importers/laz/decoder/integer_decoder.hpp"
#include "importers/laz/decoder/items/item_decoder.hpp"

namespace scancast::laz {

class WavePacketDecoder {
  public:
    static constexpr std::size_t bytes = 29;

    void reset();
    /// `last`, in place, becomes the next.
    void decode(ArithmeticDecoder& decoder, std::byte* last);

  private:
    std::uint32_t kind_ = 0;  // of the last step to a next offset
    std::int32_t step_ = 0;
    SymbolModel<256> descriptor_;
    std::array<SymbolModel<4>, 4> kinds_;
    IntegerDecoder<32> steps_{1}, sizes_{1}, returnPoint_{1}, direction_{3};
};

class WavePacket13 final : public ItemDecoder {
  public:
    explicit WavePacket13(ArithmeticDecoder& decoder) : decoder_(decoder) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    ArithmeticDecoder& decoder_;
    std::array<std::byte, WavePacketDecoder::bytes> last_{};
    WavePacketDecoder packets_;
};

}  // namespace scancast::laz
