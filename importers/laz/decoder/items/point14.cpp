#include "importers/laz/decoder/items/point14.hpp"

#include <cstring>

#include "importers/laz/decoder/items/fields.hpp"

namespace scancast::laz {

namespace {

enum Layer : std::size_t {
    returnsAndXy,
    z,
    classification,
    flags,
    intensity,
    angle,
    userData,
    source,
    gpsTime
};

// Bits of what has changed since the channel's last point.
constexpr std::uint32_t channelChanged = 64, sourceChanged = 32, timeChanged = 16, angleChanged = 8,
                        returnsChanged = 4;

std::uint32_t byteIn(const std::byte* item, std::size_t at) {
    return static_cast<std::uint32_t>(item[at]);
}

std::size_t channelIn(const std::byte* item) {
    return byteIn(item, atFlags14) >> 4 & 3U;
}

void setChannel(std::byte* item, std::size_t channel) {
    item[atFlags14] =
        static_cast<std::byte>((byteIn(item, atFlags14) & ~0x30U) | static_cast<std::uint32_t>(channel) << 4);
}

}  // namespace

void Point14::Channel::start(const std::byte* item) {
    used = true;
    timeChanged = false;
    std::memcpy(last.data(), item, itemBytes);
    resetAll(changed);
    channelStep.reset();
    resetAll(returns);
    resetAll(returnNumber);
    returnNumberAtSameTime.reset();
    medians = {};
    for (auto* integer : {&x, &y, &z}) integer->reset();
    heights.fill(loadLe<std::int32_t>(item + atZ));
    resetAll(classification);
    resetAll(userData);
    resetAll(flags);
    intensities.fill(loadLe<std::uint16_t>(item + atIntensity));
    for (auto* integer : {&intensity, &angle, &source}) integer->reset();
    times.start(loadLe<std::uint64_t>(item + atTime14));
}

void Point14::start(const std::byte* item, std::span<ArithmeticDecoder> layers, std::size_t& channel) {
    layers_ = layers;
    for (auto& other : channels_)
        if (other) other->used = false;
    current_ = channel = channelIn(item);
    channelOf(current_, item);
}

/// The channel, which begins with `item` if it has not begun.
Point14::Channel& Point14::channelOf(std::size_t number, const std::byte* item) {
    auto& channel = channels_[number];
    if (!channel) channel = std::make_unique<Channel>();
    if (!channel->used) channel->start(item);
    return *channel;
}

void Point14::decode(std::byte* item, std::size_t& channel) {
    Channel* state = channels_[current_].get();
    const std::byte* const before = state->last.data();
    const std::uint32_t r = byteIn(before, atReturns) & 15U;
    const std::uint32_t n = byteIn(before, atReturns) >> 4;
    const std::size_t context = (r == 1 ? 1U : 0U) + (r >= n ? 2U : 0U) + (state->timeChanged ? 4U : 0U);
    ArithmeticDecoder& lead = layers_[returnsAndXy];
    const std::uint32_t changed = lead.symbol(state->changed[context]);
    if (changed & channelChanged) {
        current_ = (current_ + lead.symbol(state->channelStep) + 1) % channels;
        state = &channelOf(current_, before);
        setChannel(state->last.data(), current_);
    }
    channel = tellsChannelAlways_ || (changed & channelChanged) ? current_ : 0;

    state->timeChanged = (changed & timeChanged) != 0;
    const Returns returns = decodeReturns(*state, changed);
    decodePosition(*state, returns);
    decodeAttributes(*state, changed, returns);
    std::memcpy(item, state->last.data(), itemBytes);
}

Point14::Returns Point14::decodeReturns(Channel& channel, std::uint32_t changed) {
    ArithmeticDecoder& lead = layers_[returnsAndXy];
    std::byte& byte = channel.last[atReturns];
    const std::uint32_t lastR = static_cast<std::uint32_t>(byte) & 15U;
    const std::uint32_t lastN = static_cast<std::uint32_t>(byte) >> 4;
    const std::uint32_t n = changed & returnsChanged ? lead.symbol(channel.returns[lastN]) : lastN;
    std::uint32_t r = lastR;
    switch (changed & 3U) {
        case 0:
            break;
        case 1:
            r = (lastR + 1) % 16;
            break;
        case 2:
            r = (lastR + 15) % 16;
            break;
        default:
            r = channel.timeChanged ? lead.symbol(channel.returnNumber[lastR])
                                    : (lastR + lead.symbol(channel.returnNumberAtSameTime) + 2) % 16;
    }
    byte = static_cast<std::byte>(n << 4 | r);
    return {r, n};
}

void Point14::decodePosition(Channel& channel, Returns returns) {
    ArithmeticDecoder& lead = layers_[returnsAndXy];
    std::byte* const last = channel.last.data();
    const auto context = static_cast<std::size_t>(returnContext14[returns.n][returns.r] - '0');
    auto& [xMedian, yMedian] = channel.medians[2 * context + (channel.timeChanged ? 1 : 0)];
    const std::size_t single = returns.n == 1 ? 1 : 0;
    const std::int32_t dx = channel.x.decode(lead, xMedian.get(), single);
    addTo(last + atX, dx);
    xMedian.add(dx);
    const std::int32_t dy =
        channel.y.decode(lead, yMedian.get(), single + evenContext(channel.x.lastSize(), 20));
    addTo(last + atY, dy);
    yMedian.add(dy);
    if (!layers_[z].feed.isOpen()) return;
    std::int32_t& height = channel.heights[returnLevel(returns.n, returns.r)];
    const std::uint32_t size = (channel.x.lastSize() + channel.y.lastSize()) / 2;
    height = channel.z.decode(layers_[z], height, single + evenContext(size, 18));
    storeLe(last + atZ, height);
}

void Point14::decodeAttributes(Channel& channel, std::uint32_t changed, Returns returns) {
    std::byte* const last = channel.last.data();
    const std::size_t newTime = channel.timeChanged ? 1 : 0;
    const std::size_t place =
        (returns.r == 1 ? 2U : 0U) + (returns.r >= returns.n ? 1U : 0U);  // 3: the only return
    const auto number16 = [&](Layer layer, std::size_t at, IntegerDecoder<16>& integer, std::size_t context) {
        const auto number = integer.decode(layers_[layer], loadLe<std::uint16_t>(last + at), context);
        storeLe(last + at, static_cast<std::uint16_t>(number));
    };
    if (ArithmeticDecoder& layer = layers_[classification]; layer.feed.isOpen()) {
        const std::size_t context = (byteIn(last, atClass14) & 31U) * 2 + (place == 3 ? 1 : 0);
        last[atClass14] = static_cast<std::byte>(layer.symbol(channel.classification[context]));
    }
    if (ArithmeticDecoder& layer = layers_[flags]; layer.feed.isOpen()) {
        // Edge of flight line, scan direction, four flags; the channel is between them.
        const std::uint32_t byte = byteIn(last, atFlags14);
        const std::uint32_t six = layer.symbol(channel.flags[(byte >> 2 & 0x30U) | (byte & 15U)]);
        last[atFlags14] = static_cast<std::byte>((byte & 0x30U) | (six & 0x30U) << 2 | (six & 15U));
    }
    if (layers_[intensity].feed.isOpen()) {
        std::uint16_t& number = channel.intensities[2 * place + newTime];
        number = static_cast<std::uint16_t>(channel.intensity.decode(layers_[intensity], number, place));
        storeLe(last + atIntensity, number);
    }
    if ((changed & angleChanged) && layers_[angle].feed.isOpen())
        number16(angle, atAngle14, channel.angle, newTime);
    if (ArithmeticDecoder& layer = layers_[userData]; layer.feed.isOpen())
        last[atUserData] =
            static_cast<std::byte>(layer.symbol(channel.userData[byteIn(last, atUserData) / 4]));
    if ((changed & sourceChanged) && layers_[source].feed.isOpen())
        number16(source, atSource14, channel.source, 0);
    if (channel.timeChanged && layers_[gpsTime].feed.isOpen())
        storeLe(last + atTime14, channel.times.decode(layers_[gpsTime]));
}

}  // namespace scancast::laz
