// The arithmetic decoder of LASzip: symbols of adaptive models, and plain bits, out of a stream of bytes. 32-bit numbers
// throughout, as in the encoder. Whatever the stream holds, every call ends and returns a symbol that the model has: `value_`
// stays below `length_`, which no interval of a model reduces to nothing. What cannot be is remembered, and asked for by
// damage() from time to time. Owned by a chunk's decoder. Place: feed → **arithmetic decoder** → items.
#pragma once

#include "importers/laz/decoder/byte_feed.hpp"
#include "importers/laz/decoder/models.hpp"

namespace scancast::laz {

class ArithmeticDecoder {
  public:
    ByteFeed feed;

    /// Begins to decode with the feed's next byte.
    void start();
    /// Has no bytes.
    void close();

    bool bit(BitModel& model) {
        const std::uint32_t split = model.probabilityOfZero() * (length_ >> BitModel::shift);
        const bool one = value_ >= split;
        if (one) {
            value_ -= split;
            length_ -= split;
        } else {
            length_ = split;
        }
        renormalize();
        model.count(one);
        return one;
    }

    template <std::uint32_t symbols>
    std::uint32_t symbol(SymbolModel<symbols>& model) {
        model.prepare();
        // At least 2^24 / 2^15, so `place` is below 2^15 + 64.
        const std::uint32_t part = length_ >> SymbolModel<symbols>::shift;
        const std::uint32_t place = value_ / part;
        const std::uint32_t symbol = model.find(place);
        const std::uint32_t from = model.from(symbol) * part;
        const std::uint32_t to = symbol == model.last ? length_ : model.from(symbol + 1) * part;
        value_ -= from;
        length_ = to - from;
        renormalize();
        model.count(symbol);
        return symbol;
    }

    /// 1 to 32 bits, each as likely as the other.
    std::uint32_t bits(std::uint32_t count) {
        if (count > 19) {
            const std::uint32_t low = bits(16);
            return bits(count - 16) << 16 | low;
        }
        length_ >>= count;
        const std::uint32_t number = value_ / length_;
        value_ -= number * length_;
        renormalize();
        if (number >> count != 0) [[unlikely]]
            spoil();
        return number & ((1U << count) - 1);
    }
    std::uint32_t number32() { return bits(32); }
    std::uint64_t number64() {
        const std::uint64_t low = number32();
        return static_cast<std::uint64_t>(number32()) << 32 | low;
    }

    /// Remembers that the stream says what no encoder does.
    void spoil() { spoilt_ = true; }
    /// Why the stream is none that an encoder wrote, as a clause; nullptr: nothing is known against it. An encoder ends with
    /// what the decoder reads ahead; `slack`: so many bytes may be missing all the same.
    const char* damage(std::uint64_t slack = 0) const;

  private:
    static constexpr std::uint32_t leastLength = 1U << 24;

    void renormalize() {
        while (length_ < leastLength) {
            value_ = value_ << 8 | feed.next();
            length_ <<= 8;
        }
    }

    std::uint32_t value_ = 0, length_ = 0xffffffff;
    bool spoilt_ = false;
};

}  // namespace scancast::laz
