#include "importers/e57/packed_column.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

#include "files/bytes.hpp"

namespace scancast::import_e57 {

namespace {

constexpr std::size_t reach = 16;  ///< bytes that a load may take behind the last
constexpr unsigned mostBitsOfALoad = 57;

}  // namespace

void PackedColumn::append(std::span<const std::byte> bytes) {
    if (bytes.empty()) return;
    const auto taken = static_cast<std::size_t>(bitAt_ / 8);
    // What was taken goes when it is more than what would be moved: each byte moves once at most, on the average.
    if (taken > 0 && taken >= end_ - taken) {
        std::memmove(bytes_.data(), bytes_.data() + taken, end_ - taken);
        end_ -= taken;
        bitAt_ -= std::uint64_t(taken) * 8;
    }
    if (bytes_.size() < end_ + bytes.size() + reach) bytes_.resize(end_ + bytes.size() + reach);
    std::memcpy(bytes_.data() + end_, bytes.data(), bytes.size());
    end_ += bytes.size();
}

std::uint64_t PackedColumn::available() const {
    if (field_.bits == 0) return std::numeric_limits<std::uint64_t>::max();
    return (std::uint64_t(end_) * 8 - bitAt_) / field_.bits;
}

template <class Get>
void PackedColumn::takeIntegers(std::span<double> values, Get get) const {
    const auto minimum = static_cast<std::uint64_t>(field_.minimum);
    const auto value = [&](std::size_t i) {
        return static_cast<double>(static_cast<std::int64_t>(minimum + get(i)));
    };
    if (field_.encoding == Encoding::Integer) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(i);
    } else {
        const double scale = field_.scale, offset = field_.offset;
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(i) * scale + offset;
    }
}

void PackedColumn::take(std::span<double> values) {
    assert(values.size() <= available());
    if (values.empty()) return;
    const auto* const data = bytes_.data();
    const auto bits = field_.bits;
    const auto at = bitAt_;
    bitAt_ += std::uint64_t(bits) * values.size();
    if (bits == 0) return takeIntegers(values, [](std::size_t) { return std::uint64_t(0); });
    if (!field_.isInteger()) {
        // Floats begin at whole bytes: nothing else is in their stream.
        const auto* const from = data + at / 8;
        if (field_.encoding == Encoding::Float32)
            for (std::size_t i = 0; i < values.size(); ++i)
                values[i] = static_cast<double>(loadLe<float>(from + i * 4));
        else
            std::memcpy(values.data(), from, values.size() * 8);
        return;
    }
    const auto mask = ~std::uint64_t(0) >> (64 - bits);
    if (bits <= mostBitsOfALoad)
        return takeIntegers(values, [=](std::size_t i) {
            const auto bit = at + std::uint64_t(bits) * i;
            return (loadLe<std::uint64_t>(data + bit / 8) >> (bit % 8)) & mask;
        });
    takeIntegers(values, [=](std::size_t i) {
        const auto bit = at + std::uint64_t(bits) * i;
        const auto low = loadLe<std::uint64_t>(data + bit / 8) >> (bit % 8);
        const auto high = std::to_integer<std::uint64_t>(data[bit / 8 + 8]);
        return (low | (bit % 8 == 0 ? 0 : high << (64 - bit % 8))) & mask;
    });
}

}  // namespace scancast::import_e57
