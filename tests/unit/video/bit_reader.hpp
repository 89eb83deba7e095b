// A reader of H.264's headers as the standard says them (Rec. ITU-T H.264, 7.3 and E.1), for tests alone: it shares no code
// with the library that wrote them.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace scancast::test {

/// NAL units of an access unit in Annex B, without their start codes.
inline std::vector<std::vector<std::uint8_t>> nalUnits(std::span<const std::uint8_t> bytes) {
    std::vector<std::vector<std::uint8_t>> units;
    for (std::size_t i = 0; i < bytes.size();) {
        const auto starts = [&](std::size_t at) {
            return at + 2 < bytes.size() && bytes[at] == 0 && bytes[at + 1] == 0 && bytes[at + 2] == 1;
        };
        if (starts(i)) {
            units.emplace_back();
            i += 3;
        } else if (i + 3 < bytes.size() && bytes[i] == 0 && starts(i + 1)) {
            ++i;  // the zero byte of a longer start code
        } else {
            if (units.empty()) throw std::runtime_error("does not begin with a start code");
            units.back().push_back(bytes[i++]);
        }
    }
    return units;
}

class BitReader {
  public:
    /// Of a NAL unit, behind its first byte.
    explicit BitReader(std::span<const std::uint8_t> unit) {
        for (std::size_t i = 1; i < unit.size(); ++i) {
            const bool isEscape = i >= 3 && unit[i] == 3 && unit[i - 1] == 0 && unit[i - 2] == 0;
            if (!isEscape) bytes_.push_back(unit[i]);
        }
    }
    unsigned bits(int count) {
        unsigned value = 0;
        while (count-- > 0) {
            value = value << 1 | (bytes_.at(at_ / 8) >> (7 - at_ % 8) & 1U);
            ++at_;
        }
        return value;
    }
    bool flag() { return bits(1) != 0; }
    /// ue(v)
    unsigned number() {
        int zeros = 0;
        while (!flag()) ++zeros;
        return (1U << zeros) - 1 + bits(zeros);
    }

  private:
    std::vector<std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

/// What a sequence parameter set of a baseline profile says.
struct Sps {
    unsigned profile = 0, constraints = 0, level = 0, orderType = 0, referenceFrames = 0;
    int width = 0, height = 0;  ///< after cropping
    bool hasColors = false, fullRange = false;
    unsigned primaries = 2, transfer = 2, matrix = 2;
    bool hasRestriction = false;
    unsigned mostReordered = 99, mostHeldBack = 99;
};

inline Sps readSps(std::span<const std::uint8_t> unit) {
    BitReader in(unit);
    Sps sps;
    sps.profile = in.bits(8);
    sps.constraints = in.bits(8);
    sps.level = in.bits(8);
    in.number();  // seq_parameter_set_id
    in.number();  // log2_max_frame_num_minus4
    sps.orderType = in.number();
    if (sps.orderType == 0) in.number();
    sps.referenceFrames = in.number();
    in.flag();
    const int wide = int(in.number()) + 1, high = int(in.number()) + 1;
    if (!in.flag()) throw std::runtime_error("interlaced");
    in.flag();
    unsigned left = 0, right = 0, top = 0, bottom = 0;
    if (in.flag()) left = in.number(), right = in.number(), top = in.number(), bottom = in.number();
    sps.width = wide * 16 - 2 * int(left + right);
    sps.height = high * 16 - 2 * int(top + bottom);
    if (!in.flag()) return sps;
    if (in.flag() && in.bits(8) == 255) in.bits(32);  // aspect ratio
    if (in.flag()) in.flag();                         // overscan
    if (in.flag()) {
        in.bits(3);
        sps.fullRange = in.flag();
        sps.hasColors = in.flag();
        if (sps.hasColors) sps.primaries = in.bits(8), sps.transfer = in.bits(8), sps.matrix = in.bits(8);
    }
    if (in.flag()) in.number(), in.number();  // where chroma lies
    if (in.flag()) in.bits(32), in.bits(32), in.flag();
    if (in.flag() || in.flag())
        throw std::runtime_error("a decoder's buffer is described, which this reader does not know");
    in.flag();
    sps.hasRestriction = in.flag();
    if (!sps.hasRestriction) return sps;
    in.flag();
    for (int i = 0; i < 4; ++i) in.number();
    sps.mostReordered = in.number();
    sps.mostHeldBack = in.number();
    return sps;
}

}  // namespace scancast::test
