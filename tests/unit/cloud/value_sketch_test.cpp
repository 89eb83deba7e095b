// Where values lie, told by a sketch. Oracle: the same values, all kept and sorted.
#include "renderer/cloud/build/value_sketch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

namespace scancast {
namespace {

constexpr std::array shares{0.0, 0.001, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 0.999, 1.0};

/// Made with one engine's own numbers: the same on any machine.
class Dice {
  public:
    double uniform() { return double(engine_()) / 4294967296.0; }
    double normal() {
        double sum = -6;
        for (int i = 0; i < 12; ++i) sum += uniform();
        return sum;
    }
    void shuffle(std::vector<double>& values) {
        for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[engine_() % i]);
    }

  private:
    std::mt19937 engine_{5};
};

struct Values {
    std::string name;
    std::vector<double> all;
    /// Where most of the values are: what precision is measured by.
    double width;
};

std::vector<Values> distributions() {
    Dice dice;
    constexpr std::size_t many = 30000;
    const auto made = [&](std::string name, double width, const std::function<double(std::size_t)>& value) {
        Values values{std::move(name), {}, width};
        for (std::size_t i = 0; i < many; ++i) values.all.push_back(value(i));
        return values;
    };
    std::vector<Values> all;
    all.push_back(made("uniform", 100, [&](auto) { return 100 * dice.uniform(); }));
    all.push_back(made("negative", 1000, [&](auto) { return -1000 * dice.uniform() - 5; }));
    all.push_back(made("a map's coordinates", 200, [&](auto) { return 5411987 + 200 * dice.uniform(); }));
    all.push_back(made("normal", 12, [&](auto) { return dice.normal(); }));
    all.push_back(made("tiny", 1e-9, [&](auto) { return 1e-9 * dice.uniform(); }));
    all.push_back(made("clusters", 110, [&](auto i) { return double(i % 3) * 50 + dice.uniform(); }));
    all.push_back(made("strays", 10, [&](auto i) {
        if (i % 5000 == 7) return i % 2 ? 1e9 : -1e9;
        return 10 * dice.uniform();
    }));
    all.push_back(made("steps", 4, [&](auto i) { return double(i % 5); }));
    all.push_back(made("constant", 1, [&](auto) { return -7.25; }));
    all.push_back(made("huge", 2e300, [&](auto) { return 1e300 * (2 * dice.uniform() - 1); }));
    all.push_back({"one", {3.5}, 1});
    all.push_back({"two", {-1, 1}, 2});
    return all;
}

ValueSketch sketchOf(const std::vector<double>& values) {
    ValueSketch sketch;
    for (const double value : values) sketch.add(value);
    return sketch;
}

// Right because of the values between the two ranks beside the wanted one, each is a quantile as good.
TEST(ValueSketch, IsAsGoodAsSorting) {
    for (auto& [name, all, width] : distributions()) {
        const ValueSketch sketch = sketchOf(all);
        EXPECT_EQ(sketch.count(), all.size());
        std::ranges::sort(all);
        for (const double q : shares) {
            const auto rank = q * double(all.size());
            const auto at = [&](double r) {
                return all[std::size_t(std::clamp(r, 0.0, double(all.size() - 1)))];
            };
            const double low = at(std::floor(rank) - 1), high = at(std::ceil(rank));
            const double found = sketch.quantile(q), cell = width / 1000;
            EXPECT_GE(found, low - cell) << name << ' ' << q;
            EXPECT_LE(found, high + cell) << name << ' ' << q;
            EXPECT_GE(found, all.front());
            EXPECT_LE(found, all.back());
        }
        EXPECT_LE(sketch.usual()[0], sketch.usual()[1]);
    }
}

TEST(ValueSketch, OrderChangesNothing) {
    Dice dice;
    for (auto& [name, all, width] : distributions()) {
        const ValueSketch first = sketchOf(all);
        const auto expectSame = [&] {
            const ValueSketch other = sketchOf(all);
            for (const double q : shares) EXPECT_EQ(other.quantile(q), first.quantile(q)) << name << ' ' << q;
        };
        std::ranges::sort(all);
        expectSame();
        std::ranges::reverse(all);
        expectSame();
        dice.shuffle(all);
        expectSame();
    }
}

// As several processes join what each has seen. Right because one sketch of all values says the same.
TEST(ValueSketch, PartsJoinedAreTheWhole) {
    for (auto& [name, all, width] : distributions()) {
        std::ranges::sort(all);  // parts as unlike as can be
        const ValueSketch whole = sketchOf(all);
        const auto part = [&](std::size_t first, std::size_t last) {
            return sketchOf({all.begin() + std::ptrdiff_t(all.size() * first / 3000),
                             all.begin() + std::ptrdiff_t(all.size() * last / 3000)});
        };
        const std::array parts{part(0, 1), part(1, 2000), part(2000, 3000), ValueSketch()};
        for (const std::array<std::size_t, 4> order :
             {std::array<std::size_t, 4>{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}}) {
            ValueSketch joined;
            for (const std::size_t i : order) joined.join(parts[i]);
            EXPECT_EQ(joined.count(), whole.count());
            for (const double q : shares)
                EXPECT_EQ(joined.quantile(q), whole.quantile(q)) << name << ' ' << q;
        }
    }
}

TEST(ValueSketch, WhatIsNotFiniteIsPassedOver) {
    ValueSketch sketch;
    EXPECT_EQ(sketch.quantile(0.5), 0);
    for (const double none : {double(NAN), double(INFINITY), -double(INFINITY)}) sketch.add(none);
    EXPECT_EQ(sketch.count(), 0U);
    EXPECT_EQ(sketch.quantile(0.5), 0);
    for (int i = 0; i < 100; ++i) {
        sketch.add(NAN);
        sketch.add(4);
        sketch.add(-INFINITY);
    }
    EXPECT_EQ(sketch.count(), 100U);
    for (const double q : shares) EXPECT_EQ(sketch.quantile(q), 4) << q;
}

TEST(ValueSketch, TheLargestAndSmallestNumbers) {
    ValueSketch sketch;
    const std::array values{-1.7976931348623157e308, -1e300, -5e-324, 0.0, -0.0, 5e-324, 1e300,
                            1.7976931348623157e308};
    for (const double value : values) sketch.add(value);
    EXPECT_EQ(sketch.quantile(0), values.front());
    EXPECT_EQ(sketch.quantile(1), values.back());
    double last = values.front();
    for (const double q : shares) {
        EXPECT_TRUE(std::isfinite(sketch.quantile(q)));
        EXPECT_GE(sketch.quantile(q), last);
        last = sketch.quantile(q);
    }
}

}  // namespace
}  // namespace scancast
