// POINT14, the point of formats 6 to 10: nine layers, of which the first - returns, channel, x and y - leads the others.
// Owned by a chunk's decoder.
#pragma once

#include <array>

#include "importers/laz/decoder/items/gps_time.hpp"
#include "importers/laz/decoder/items/median.hpp"

namespace scancast::laz {

class Point14 final : public LayeredItemDecoder {
  public:
    static constexpr std::size_t layerCount = 9;

    /// Version 3 leaves the other items with channel 0 unless it changes at this very point, as its encoder did.
    explicit Point14(int version) : tellsChannelAlways_(version >= 4) {}

    std::size_t layers() const override { return layerCount; }
    bool leads(std::size_t layer) const override { return layer == 0; }
    void start(const std::byte* item, std::span<ArithmeticDecoder> layers, std::size_t& channel) override;
    void decode(std::byte* item, std::size_t& channel) override;

  private:
    static constexpr std::size_t itemBytes = 30;

    /// What has been learnt of one scanner channel.
    struct Channel {
        void start(const std::byte* item);

        bool used = false;
        bool timeChanged = false;
        std::array<std::byte, itemBytes> last{};
        std::array<SymbolModel<128>, 8> changed;
        SymbolModel<3> channelStep;
        std::array<SymbolModel<16>, 16> returns, returnNumber;
        SymbolModel<13> returnNumberAtSameTime;
        std::array<std::pair<Median, Median>, 12> medians{};  // of differences in x and y
        IntegerDecoder<32> x{2}, y{22}, z{20};
        std::array<std::int32_t, 8> heights{};
        std::array<SymbolModel<256>, 64> classification, userData;
        std::array<SymbolModel<64>, 64> flags;
        std::array<std::uint16_t, 8> intensities{};
        IntegerDecoder<16> intensity{4}, angle{2}, source{1};
        GpsTimeDecoder<false> times;
    };
    struct Returns {
        std::uint32_t r = 0, n = 0;
    };

    Channel& channelOf(std::size_t number, const std::byte* item);
    Returns decodeReturns(Channel& channel, std::uint32_t changed);
    void decodePosition(Channel& channel, Returns returns);
    void decodeAttributes(Channel& channel, std::uint32_t changed, Returns returns);

    bool tellsChannelAlways_;
    std::span<ArithmeticDecoder> layers_;
    std::array<std::unique_ptr<Channel>, channels> channels_;
    std::size_t current_ = 0;
};

}  // namespace scancast::laz
