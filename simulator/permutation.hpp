// A uniform-looking shuffle of 0 … N-1 that needs no memory: position i of the shuffle is computed, not
// stored. A Feistel network permutes the next power of four; numbers past the end are sent round again until
// they fall inside (cycle walking), which keeps the map a bijection.
#pragma once

#include <bit>
#include <cstdint>

#include "simulator/random.hpp"

namespace scancast {

class Permutation {
  public:
    Permutation(std::uint64_t count, std::uint64_t seed) : count_(count), seed_(seed) {
        const int bits = count > 1 ? std::bit_width(count - 1) : 1;
        halfBits_ = (bits + 1) / 2;
        mask_ = (std::uint64_t(1) << halfBits_) - 1;
    }

    /// `position` < count; so is the result.
    std::uint64_t operator()(std::uint64_t position) const {
        std::uint64_t value = position;
        do value = encipher(value);
        while (value >= count_);
        return value;
    }

  private:
    static constexpr int rounds = 5;

    std::uint64_t encipher(std::uint64_t value) const {
        std::uint64_t left = value >> halfBits_, right = value & mask_;
        for (int round = 0; round < rounds; ++round) {
            const std::uint64_t next =
                left ^ (mixBits(right + seed_ * rounds + std::uint64_t(round), seed_) & mask_);
            left = right;
            right = next;
        }
        return (left << halfBits_) | right;
    }

    std::uint64_t count_, seed_, mask_ = 1;
    int halfBits_ = 1;
};

}  // namespace scancast
