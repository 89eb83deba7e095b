#include "importers/laz/decoder/items/wave_packets.hpp"

#include <cstring>

#include "files/bytes.hpp"

namespace scancast::laz {

namespace {

enum WavePacketAt : std::size_t { atOffset = 1, atSize = 9, atReturnPoint = 13, atDirection = 17 };

}  // namespace

void WavePacketDecoder::reset() {
    kind_ = 0;
    step_ = 0;
    descriptor_.reset();
    resetAll(kinds_);
    for (auto* integer : {&steps_, &sizes_, &returnPoint_, &direction_}) integer->reset();
}

void WavePacketDecoder::decode(ArithmeticDecoder& decoder, std::byte* last) {
    last[0] = static_cast<std::byte>(decoder.symbol(descriptor_));
    const auto next = [&](std::size_t at, IntegerDecoder<32>& integer, std::size_t context) {
        storeLe(last + at, integer.decode(decoder, loadLe<std::int32_t>(last + at), context));
    };
    auto offset = loadLe<std::uint64_t>(last + atOffset);
    kind_ = decoder.symbol(kinds_[kind_]);
    if (kind_ == 1) offset += loadLe<std::uint32_t>(last + atSize);
    if (kind_ == 2) {
        step_ = steps_.decode(decoder, step_);
        offset += static_cast<std::uint64_t>(static_cast<std::int64_t>(step_));
    }
    if (kind_ == 3) offset = decoder.number64();
    storeLe(last + atOffset, offset);
    next(atSize, sizes_, 0);
    next(atReturnPoint, returnPoint_, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) next(atDirection + 4 * axis, direction_, axis);
}

void WavePacket13::start(const std::byte* item) {
    std::memcpy(last_.data(), item, last_.size());
    packets_.reset();
}

void WavePacket13::decode(std::byte* item) {
    packets_.decode(decoder_, last_.data());
    std::memcpy(item, last_.data(), last_.size());
}

}  // namespace scancast::laz
