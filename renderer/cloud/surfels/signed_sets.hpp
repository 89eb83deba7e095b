// Disjoint sets whose members are known relative to each other: on the same side, or on opposite ones.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace scancast {

class SignedSets {
  public:
    explicit SignedSets(std::size_t members) : up_(members) {
        for (std::size_t i = 0; i < members; ++i) up_[i] = std::uint32_t(i) << 1;
    }

    struct Place {
        std::uint32_t root;
        bool turned;  ///< relative to the root
    };
    Place find(std::uint32_t member) {
        std::uint32_t turned = 0;
        for (;;) {
            const std::uint32_t to = up_[member], parent = to >> 1;
            if (parent == member) return {member, turned != 0};
            const std::uint32_t above = up_[parent];
            up_[member] = above ^ (to & 1);  // half the way next time
            if (above >> 1 == parent) return {parent, (turned ^ (to & 1)) != 0};
            turned ^= (above ^ to) & 1;
            member = above >> 1;
        }
    }
    /// Of two roots; the smaller one stays.
    void join(std::uint32_t a, std::uint32_t b, bool opposite) {
        if (a > b) std::swap(a, b);
        up_[b] = a << 1 | std::uint32_t(opposite);
    }

  private:
    std::vector<std::uint32_t> up_;  ///< number of a nearer one, above a bit: turned relative to that
};

}  // namespace scancast
