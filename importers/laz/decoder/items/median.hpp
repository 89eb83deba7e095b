// A median of about the last five numbers, as LASzip predicts differences: sorted, a new number drives out the highest or the
// lowest, in turn by the side on which it came in. A plain value.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace scancast::laz {

class Median {
  public:
    std::int32_t get() const { return sorted_[2]; }

    void add(std::int32_t number) {
        const bool below = dropsHighest_ ? number < sorted_[2] : number <= sorted_[2];
        const std::size_t first = dropsHighest_ ? 0 : 1;
        const std::array<std::int32_t, 4> kept{sorted_[first], sorted_[first + 1], sorted_[first + 2],
                                               sorted_[first + 3]};
        sorted_[0] = std::min(kept[0], number);
        for (std::size_t i = 1; i < 4; ++i) sorted_[i] = std::min(kept[i], std::max(kept[i - 1], number));
        sorted_[4] = std::max(kept[3], number);
        dropsHighest_ = below;
    }

  private:
    std::array<std::int32_t, 5> sorted_{};
    bool dropsHighest_ = true;
};

}  // namespace scancast::laz
