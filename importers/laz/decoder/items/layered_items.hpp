// What layered records hold besides the point: RGB14, RGBNIR14, WAVEPACKET14, BYTE14. Owned by a chunk's decoder.
#pragma once

#include <array>
#include <vector>

#include "importers/laz/decoder/items/colors.hpp"
#include "importers/laz/decoder/items/wave_packets.hpp"

namespace scancast::laz {

/// The last item of each scanner channel, and what its models know. `Fields` knows a layout:
///   Fields(bytes), layers(), reset(), decode(last, layer's number, its decoder)
/// where `last` is the whole item, of which the layer's part becomes the next.
template <class Fields>
class LayeredItem final : public LayeredItemDecoder {
  public:
    /// In version 3 a channel that goes on takes up the item of the one before it, and leaves its next one there, too, as its encoder did.
    LayeredItem(std::size_t bytes, int version) : bytes_(bytes), goesOnWithOwn_(version >= 4) {}

    std::size_t layers() const override { return Fields::layersOf(bytes_); }
    void start(const std::byte* item, std::span<ArithmeticDecoder> layers, std::size_t& channel) override;
    void decode(std::byte* item, std::size_t& channel) override;

  private:
    struct Channel {
        explicit Channel(std::size_t bytes) : last(bytes), fields(bytes) {}
        bool used = false;
        std::vector<std::byte> last;
        Fields fields;
    };
    /// True if it began with `item`.
    bool begin(std::size_t channel, const std::byte* item);

    std::size_t bytes_;
    bool goesOnWithOwn_;
    std::span<ArithmeticDecoder> layers_;
    std::array<std::unique_ptr<Channel>, channels> channels_;
    std::size_t current_ = 0;
};

struct ColorFields {
    explicit ColorFields(std::size_t) {}
    static std::size_t layersOf(std::size_t) { return 1; }
    void reset() { colors.reset(); }
    void decode(std::byte* last, std::size_t, ArithmeticDecoder& decoder) { colors.decode(decoder, last); }

    ColorDecoder colors;
};

struct ColorInfraredFields {
    explicit ColorInfraredFields(std::size_t) {}
    static std::size_t layersOf(std::size_t) { return 2; }
    void reset() {
        colors.reset();
        infrared.reset();
    }
    /// The part of the item that a layer holds.
    void decode(std::byte* last, std::size_t layer, ArithmeticDecoder& decoder) {
        if (layer == 0)
            colors.decode(decoder, last);
        else
            infrared.decode(decoder, last + ColorDecoder::bytes);
    }

    ColorDecoder colors;
    InfraredDecoder infrared;
};

struct WavePacketFields {
    explicit WavePacketFields(std::size_t) {}
    static std::size_t layersOf(std::size_t) { return 1; }
    void reset() { packets.reset(); }
    void decode(std::byte* last, std::size_t, ArithmeticDecoder& decoder) { packets.decode(decoder, last); }

    WavePacketDecoder packets;
};

struct ExtraFields {
    explicit ExtraFields(std::size_t bytes) : differences(bytes) {}
    static std::size_t layersOf(std::size_t bytes) { return bytes; }
    void reset() {
        for (auto& model : differences) model.reset();
    }
    void decode(std::byte* last, std::size_t layer, ArithmeticDecoder& decoder) {
        last[layer] = static_cast<std::byte>(static_cast<std::uint32_t>(last[layer]) +
                                             decoder.symbol(differences[layer]));
    }

    std::vector<SymbolModel<256>> differences;
};

extern template class LayeredItem<ColorFields>;
extern template class LayeredItem<ColorInfraredFields>;
extern template class LayeredItem<WavePacketFields>;
extern template class LayeredItem<ExtraFields>;

}  // namespace scancast::laz
