// The bytestream of one field: bytes of packets in, numbers out. Values lie bit behind bit, lowest first, without a gap
// between packets. Owned and used by one thread. Pipeline: packets → **columns** → points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "importers/e57/fields.hpp"

namespace scancast::import_e57 {

class PackedColumn {
  public:
    explicit PackedColumn(const Field& field) : field_(field) {}

    void append(std::span<const std::byte> bytes);
    /// Whole values that are there; without bits, as many as one likes.
    std::uint64_t available() const;
    /// Bytes that wait.
    std::size_t waiting() const { return end_ - static_cast<std::size_t>(bitAt_ / 8); }
    /// The next values, of which so many are available.
    void take(std::span<double> values);
    /// Passes over as many.
    void skip(std::size_t count) { bitAt_ += std::uint64_t(field_.bits) * count; }
    unsigned bits() const { return field_.bits; }

  private:
    template <class Get>
    void takeIntegers(std::span<double> values, Get get) const;

    Field field_;
    std::vector<std::byte> bytes_;  ///< `end_` of them, then room for loads that reach beyond
    std::size_t end_ = 0;
    std::uint64_t bitAt_ = 0;  ///< of the next value
};

}  // namespace scancast::import_e57
