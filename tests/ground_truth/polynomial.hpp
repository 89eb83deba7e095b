// The first root of a polynomial in an interval, found between the extrema that its derivative's roots are:
// no formula that loses digits, no starting value to guess.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace scancast {

/// coefficients[i] belongs to t^i.
template <std::size_t N>
double valueOf(const std::array<double, N>& coefficients, double t) {
    double value = 0;
    for (std::size_t i = N; i-- > 0;) value = value * t + coefficients[i];
    return value;
}

/// The one root between two places where the signs differ.
template <std::size_t N>
double rootBetween(const std::array<double, N>& coefficients, double low, double high) {
    const bool rising = valueOf(coefficients, low) < 0;
    double at = (low + high) / 2;
    for (int i = 0; i < 100 && low < high; ++i) {
        double value = 0, slope = 0;
        for (std::size_t k = N; k-- > 0;) {
            slope = slope * at + value;
            value = value * at + coefficients[k];
        }
        if (value == 0) return at;
        ((value < 0) == rising ? low : high) = at;
        const double newton = at - value / slope;
        const double next = newton > low && newton < high ? newton : (low + high) / 2;
        if (std::abs(next - at) <= 1e-15 * (1 + std::abs(at))) return next;
        at = next;
    }
    return at;
}

/// All places where the sign changes in [low, high], in order; returns how many. Roots that only touch zero
/// are not counted.
template <std::size_t N>
std::size_t signChanges(const std::array<double, N>& coefficients, double low, double high,
                        std::array<double, N>& roots) {
    std::size_t count = 0;
    if constexpr (N >= 2) {
        std::array<double, N - 1> slope{}, turns{};
        for (std::size_t i = 1; i < N; ++i) slope[i - 1] = double(i) * coefficients[i];
        const std::size_t turning = signChanges(slope, low, high, turns);
        double from = low, before = valueOf(coefficients, low);
        for (std::size_t i = 0; i <= turning; ++i) {
            const double to = i < turning ? turns[i] : high, value = valueOf(coefficients, to);
            if ((before < 0) != (value < 0) && count < N)
                roots[count++] = rootBetween(coefficients, from, to);
            from = to;
            before = value;
        }
    }
    return count;
}

template <std::size_t N>
std::optional<double> firstRoot(const std::array<double, N>& coefficients, double low, double high) {
    std::array<double, N> roots{};
    return signChanges(coefficients, low, high, roots) > 0 ? std::optional(roots[0]) : std::nullopt;
}

}  // namespace scancast
