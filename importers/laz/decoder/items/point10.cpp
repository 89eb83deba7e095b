// POINT10, the point of formats 0 to 5, in both its versions.
#include "importers/laz/decoder/items/point10.hpp"

#include <cstring>

#include "importers/laz/decoder/items/fields.hpp"

namespace scancast::laz {

namespace {

constexpr std::size_t itemBytes = 20;

std::int32_t medianOf(const std::array<std::int32_t, 3>& numbers) {
    const auto [low, high] = std::minmax(numbers[0], numbers[1]);
    return std::clamp(numbers[2], low, high);
}

std::uint8_t byteAt(const std::byte* item, std::size_t at) {
    return static_cast<std::uint8_t>(item[at]);
}

}  // namespace

void Point10Bytes::reset() {
    resetAll(returns);
    resetAll(classification);
    resetAll(userData);
}

void Point10Bytes::decode(ArithmeticDecoder& decoder, Models& models, std::byte& byte) {
    byte = static_cast<std::byte>(decoder.symbol(models[static_cast<std::uint8_t>(byte)]));
}

// --- version 1 ---

void Point10V1::start(const std::byte* item) {
    std::memcpy(last_.data(), item, itemBytes);
    xDifferences_ = yDifferences_ = {};
    turn_ = 0;
    bytes_.reset();
    changed_.reset();
    for (auto* integer : {&x_, &y_, &z_}) integer->reset();
    for (auto* integer : {&intensity_, &source_}) integer->reset();
    angle_.reset();
}

void Point10V1::decode(std::byte* item) {
    std::byte* const last = last_.data();
    const std::int32_t dx = x_.decode(decoder_, medianOf(xDifferences_));
    addTo(last + atX, dx);
    std::uint32_t size = x_.lastSize();
    const std::int32_t dy = y_.decode(decoder_, medianOf(yDifferences_), std::min(size, 19U));
    addTo(last + atY, dy);
    size = (size + y_.lastSize()) / 2;
    storeLe(last + atZ, z_.decode(decoder_, loadLe<std::int32_t>(last + atZ), std::min(size, 19U)));
    decodeOthers(decoder_.symbol(changed_), size);
    xDifferences_[turn_] = dx;
    yDifferences_[turn_] = dy;
    turn_ = (turn_ + 1) % xDifferences_.size();
    std::memcpy(item, last, itemBytes);
}

void Point10V1::decodeOthers(std::uint32_t changed, std::uint32_t size) {
    std::byte* const last = last_.data();
    const auto number16 = [&](std::size_t at, IntegerDecoder<16>& integer) {
        const auto number = integer.decode(decoder_, loadLe<std::uint16_t>(last + at));
        storeLe(last + at, static_cast<std::uint16_t>(number));
    };
    if (changed & 32) number16(atIntensity, intensity_);
    if (changed & 16) bytes_.decode(decoder_, bytes_.returns, last[atReturns]);
    if (changed & 8) bytes_.decode(decoder_, bytes_.classification, last[atClass10]);
    if (changed & 4)
        last[atAngle10] =
            static_cast<std::byte>(angle_.decode(decoder_, byteAt(last, atAngle10), size < 3 ? 1 : 0));
    if (changed & 2) bytes_.decode(decoder_, bytes_.userData, last[atUserData]);
    if (changed & 1) number16(atSource10, source_);
}

// --- version 2 ---

void Point10V2::start(const std::byte* item) {
    std::memcpy(last_.data(), item, itemBytes);
    // As the encoder has it.
    storeLe<std::uint16_t>(last_.data() + atIntensity, 0);
    medians_ = {};
    intensities_ = {};
    heights_ = {};
    bytes_.reset();
    changed_.reset();
    resetAll(angles_);
    for (auto* integer : {&x_, &y_, &z_}) integer->reset();
    for (auto* integer : {&intensity_, &source_}) integer->reset();
}

void Point10V2::decode(std::byte* item) {
    std::byte* const last = last_.data();
    const std::uint32_t changed = decoder_.symbol(changed_);
    if (changed & 32) bytes_.decode(decoder_, bytes_.returns, last[atReturns]);
    const std::uint32_t r = byteAt(last, atReturns) & 7U;
    const std::uint32_t n = byteAt(last, atReturns) >> 3 & 7U;
    const std::size_t context = returnContext10[n][r];
    if (changed != 0) decodeOthers(changed, context);

    const std::size_t single = n == 1 ? 1 : 0;
    auto& [xMedian, yMedian] = medians_[context];
    const std::int32_t dx = x_.decode(decoder_, xMedian.get(), single);
    addTo(last + atX, dx);
    xMedian.add(dx);
    const std::int32_t dy = y_.decode(decoder_, yMedian.get(), single + evenContext(x_.lastSize(), 20));
    addTo(last + atY, dy);
    yMedian.add(dy);
    std::int32_t& height = heights_[returnLevel(n, r)];
    height = z_.decode(decoder_, height, single + evenContext((x_.lastSize() + y_.lastSize()) / 2, 18));
    storeLe(last + atZ, height);
    std::memcpy(item, last, itemBytes);
}

void Point10V2::decodeOthers(std::uint32_t changed, std::size_t context) {
    std::byte* const last = last_.data();
    std::uint16_t& intensity = intensities_[context];
    if (changed & 16)
        intensity = static_cast<std::uint16_t>(
            intensity_.decode(decoder_, intensity, std::min<std::size_t>(context, 3)));
    storeLe(last + atIntensity, intensity);
    if (changed & 8) bytes_.decode(decoder_, bytes_.classification, last[atClass10]);
    if (changed & 4) {
        auto& model = angles_[byteAt(last, atReturns) >> 6 & 1U];
        last[atAngle10] = static_cast<std::byte>(byteAt(last, atAngle10) + decoder_.symbol(model));
    }
    if (changed & 2) bytes_.decode(decoder_, bytes_.userData, last[atUserData]);
    if (changed & 1) {
        const auto source = source_.decode(decoder_, loadLe<std::uint16_t>(last + atSource10));
        storeLe(last + atSource10, static_cast<std::uint16_t>(source));
    }
}

}  // namespace scancast::laz
