// GPS times: 64-bit numbers that go on in steps, of up to four sequences side by side. GPSTIME11 version 1 knows one sequence;
// version 2 and POINT14 share the machine of four. Owned by an item's decoder.
#pragma once

#include <array>

#include "importers/laz/decoder/integer_decoder.hpp"
#include "importers/laz/decoder/items/item_decoder.hpp"

namespace scancast::laz {

/// The machine of four sequences. `mayStay`: a time may be said to be that of the point before (GPSTIME11); POINT14 says so elsewhere.
template <bool mayStay>
class GpsTimeDecoder {
  public:
    void start(std::uint64_t time);
    /// The next time, as the bits of a double.
    std::uint64_t decode(ArithmeticDecoder& decoder);

  private:
    struct Sequence {
        std::uint64_t time = 0;
        std::int32_t step = 0;
        int extremes = 0;  // times in turn that the step was of no use
    };
    static constexpr int greatestFactor = 500;
    static constexpr int leastFactor = -10;
    static constexpr std::uint32_t stay = mayStay ? 1 : 0;
    static constexpr std::uint32_t elsewhere = greatestFactor - leastFactor + 1 + stay;  // the symbol

    /// False: another sequence goes on.
    bool decodeWithoutStep(ArithmeticDecoder& decoder);
    bool decodeSteps(ArithmeticDecoder& decoder);
    void beginSequence(ArithmeticDecoder& decoder);
    std::int32_t decodeFactor(ArithmeticDecoder& decoder, Sequence& sequence, int factor);

    std::array<Sequence, 4> sequences_{};
    std::size_t current_ = 0, newest_ = 0;
    SymbolModel<5 + stay> withoutStep_;
    SymbolModel<greatestFactor - leastFactor + 5 + stay> factors_;
    IntegerDecoder<32> steps_{9};
};

class GpsTime11V1 final : public ItemDecoder {
  public:
    explicit GpsTime11V1(ArithmeticDecoder& decoder) : decoder_(decoder) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    void decodeWithoutStep();
    void decodeSteps();
    void countExtreme(std::int32_t difference);

    ArithmeticDecoder& decoder_;
    std::uint64_t time_ = 0;
    std::int32_t step_ = 0;
    int extremes_ = 0;
    SymbolModel<512> factors_;
    SymbolModel<3> withoutStep_;
    IntegerDecoder<32> steps_{6};
};

class GpsTime11V2 final : public ItemDecoder {
  public:
    explicit GpsTime11V2(ArithmeticDecoder& decoder) : decoder_(decoder) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    ArithmeticDecoder& decoder_;
    GpsTimeDecoder<true> times_;
};

}  // namespace scancast::laz
