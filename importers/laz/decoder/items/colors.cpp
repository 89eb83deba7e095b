#include "importers/laz/decoder/items/colors.hpp"

#include <cstring>

#include "importers/laz/decoder/items/fields.hpp"

namespace scancast::laz {

namespace {

int valueOf(std::byte byte) {
    return static_cast<int>(byte);
}

/// Prediction + the next symbol, modulo 256.
std::byte next(ArithmeticDecoder& decoder, SymbolModel<256>& model, int prediction) {
    return static_cast<std::byte>(static_cast<std::uint32_t>(prediction) + decoder.symbol(model));
}

}  // namespace

void ColorDecoder::reset() {
    changed_.reset();
    resetAll(differences_);
}

void ColorDecoder::decode(ArithmeticDecoder& decoder, std::byte* last) {
    constexpr std::uint32_t differs = 64;  // green and blue from red
    std::byte before[bytes];
    std::memcpy(before, last, bytes);
    const std::uint32_t changed = decoder.symbol(changed_);
    for (std::size_t half = 0; half < 2; ++half)
        if (changed & 1U << half) last[half] = next(decoder, differences_[half], valueOf(before[half]));
    if (!(changed & differs)) {
        std::memcpy(last + 2, last, 2);
        std::memcpy(last + 4, last, 2);
        return;
    }
    for (std::size_t half = 0; half < 2; ++half) {
        const std::size_t green = 2 + half, blue = 4 + half;
        const int red = valueOf(last[half]) - valueOf(before[half]);
        if (changed & 4U << half)
            last[green] = next(decoder, differences_[green], clampToByte(red + valueOf(before[green])));
        if (changed & 16U << half) {
            const int both = (red + valueOf(last[green]) - valueOf(before[green])) / 2;
            last[blue] = next(decoder, differences_[blue], clampToByte(both + valueOf(before[blue])));
        }
    }
}

void InfraredDecoder::reset() {
    changed_.reset();
    resetAll(differences_);
}

void InfraredDecoder::decode(ArithmeticDecoder& decoder, std::byte* last) {
    const std::uint32_t changed = decoder.symbol(changed_);
    for (std::size_t half = 0; half < 2; ++half)
        if (changed & 1U << half) last[half] = next(decoder, differences_[half], valueOf(last[half]));
}

void Rgb12V1::start(const std::byte* item) {
    std::memcpy(last_.data(), item, last_.size());
    changed_.reset();
    values_.reset();
}

void Rgb12V1::decode(std::byte* item) {
    const std::uint32_t changed = decoder_.symbol(changed_);
    for (std::size_t i = 0; i < last_.size(); ++i)
        if (changed & 1U << i)
            last_[i] = static_cast<std::byte>(values_.decode(decoder_, valueOf(last_[i]), i));
    std::memcpy(item, last_.data(), last_.size());
}

void Rgb12V2::start(const std::byte* item) {
    std::memcpy(last_.data(), item, last_.size());
    colors_.reset();
}

void Rgb12V2::decode(std::byte* item) {
    colors_.decode(decoder_, last_.data());
    std::memcpy(item, last_.data(), last_.size());
}

}  // namespace scancast::laz
