// Levels that fade instead of switching: between "the node itself" and "its children in its place" lies a
// band of spacings on screen in which both are drawn, sample by sample. Pure functions of the view, so
// pictures stay the same on every device and any number of threads. Pipeline: part of **select**; devices ask
// isDrawn's arithmetic of every sample.
//
// Of a run, the samples whose turn comes before its share are drawn. Turns are the multiples of the golden
// ratio, modulo 1, in the order of the samples, which is Morton order: the first so many of them are spread
// evenly over the node whatever the share, and a larger share only adds samples.
#pragma once

#include <cstdint>

namespace scancast {

/// How wide the band is that pictures are drawn with: from τ to this much more. A node covers about τ² px a
/// sample, so fine pictures change little where one node switches, and fading costs them most.
double fadeBand(double detail);

struct FadeShares {
    double own = 1;       ///< of the node's own samples
    double children = 0;  ///< of its children's
};

/// Shares of a node with this spacing on screen, px, when `detail` is τ, px. The node stays whole until its
/// children are, so there is a whole level everywhere: no holes. At or below τ: the node alone; from (1 +
/// band) · τ: its children alone. Both shares are continuous and monotone in the spacing where band > 0.
FadeShares fadeShares(double spacing, double detail, double band);

/// Multiples of this are the samples' turns: 2³² / golden ratio.
inline constexpr std::uint32_t turnStep = 0x9e3779b9u;
inline constexpr std::uint32_t everyTurn = 0xffffffffu;

/// A run's sample is drawn if its index there times turnStep, modulo 2³², is not above this. Sample 0 always
/// is.
inline std::uint32_t lastTurn(double share) {
    const double turns = share * 4294967296.0;
    return turns < 4294967295.0 ? static_cast<std::uint32_t>(turns > 0 ? turns : 0) : everyTurn;
}

inline bool isDrawn(std::uint32_t index, std::uint32_t last) {
    return index * turnStep <= last;
}

}  // namespace scancast
