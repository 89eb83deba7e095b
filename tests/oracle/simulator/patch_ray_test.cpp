// Rays and patches: what meets a patch is on it, and nothing on it is missed.
#include "tests/ground_truth/patch_ray.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/ground_truth/box_tree.hpp"
#include "tests/ground_truth/polynomial.hpp"
#include "tests/support/pictures/analytic_cut.hpp"

namespace scancast {
namespace {

using test::Numbers;

std::vector<Patch> someOfEveryShape(Numbers& numbers, int count) {
    const auto vector = [&](double size) { return numbers.onSphere() * numbers.uniform(0.3, size); };
    std::vector<Patch> patches;
    for (int i = 0; i < count; ++i) {
        patches.push_back(Patch::trapezoid(vector(2), vector(2), vector(2), numbers.uniform(0, 1.3)));
        patches.push_back(Patch::trapezoid(vector(2), vector(2), vector(2), 0));
        patches.push_back(
            Patch::tube(vector(2), vector(3), numbers.uniform(0.1, 1), numbers.uniform(0.1, 1)));
        patches.push_back(Patch::ball(vector(2), numbers.uniform(0.1, 2)));
        patches.push_back(Patch::disc(vector(2), numbers.uniform(0, 0.5), numbers.uniform(0.6, 2)));
        patches.push_back(
            Patch::torus(vector(2), vector(1), numbers.uniform(0.8, 2), numbers.uniform(0.05, 0.7)));
    }
    return patches;
}

// A ray aimed at a point of the patch must meet the patch there or before; and wherever it meets it, the
// patch's own parametrisation gives that very place, with the same coordinates and normal.
TEST(PatchRay, MeetsExactlyThePointsOfThePatch) {
    Numbers numbers(1);
    for (const Patch& patch : someOfEveryShape(numbers, 60)) {
        for (int i = 0; i < 200; ++i) {
            const SurfacePoint target = patch.at(numbers.uniform(), numbers.uniform());
            const glm::dvec3 eye = numbers.onSphere() * numbers.uniform(0.1, 30);
            const Ray ray{eye, (target.position - eye) * numbers.uniform(0.1, 10)};
            const auto hit = intersect(patch, ray, 0, 1e9);
            ASSERT_TRUE(hit) << "shape " << int(patch.shape);
            const double reach = glm::distance(eye, target.position);
            ASSERT_LE(hit->t * glm::length(ray.direction), reach * (1 + 1e-7) + 1e-7);
            const SurfacePoint there = patch.at(hit->a, hit->b);
            ASSERT_LT(glm::distance(there.position, ray.at(hit->t)), 2e-6) << "shape " << int(patch.shape);
            ASSERT_LT(glm::distance(there.position, hit->point.position), 2e-6);
            ASSERT_LT(glm::distance(there.normal, hit->point.normal), 2e-5F);
            ASSERT_NEAR(there.t, hit->point.t, 2e-6);
            if (hit->a > 1e-3 && hit->a < 1 - 1e-3) {
                ASSERT_NEAR(there.s, hit->point.s, 1e-5);
            }
        }
    }
}

// The bounds contain the patch: samples of it are inside; and they are tight for a torus, by its widest
// circle.
TEST(PatchRay, BoundsHoldThePatch) {
    Numbers numbers(2);
    for (const Patch& patch : someOfEveryShape(numbers, 40)) {
        const auto [low, high] = patch.bounds();
        for (int i = 0; i < 300; ++i) {
            const glm::dvec3 at = patch.at(numbers.uniform(), numbers.uniform()).position;
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_GE(at[axis], low[axis] - 1e-9);
                ASSERT_LE(at[axis], high[axis] + 1e-9);
            }
        }
    }
    const auto [low, high] = Patch::torus({0, 0, 0}, {0, 0, 1}, 2, 0.5).bounds();
    EXPECT_NEAR(high.x, 2.5, 1e-12);
    EXPECT_NEAR(low.z, -0.5, 1e-12);
}

// Pappus: a torus' part outside its middle circle has the area 2π² R r + 4π r², the inside the rest. Uniform
// parameters must fall on it in that proportion.
TEST(Torus, IsCoveredEvenly) {
    const double ring = 1, tube = 0.4;
    const Patch torus = Patch::torus({0, 0, 0}, {0, 0, 1}, ring, tube);
    EXPECT_NEAR(torus.area(), 4 * 9.869604401089358 * ring * tube, 1e-9);
    int outside = 0, top = 0;
    constexpr int count = 100000;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 at =
            torus.at((i + 0.5) / count, (i * 0.6180339887498949) - std::floor(i * 0.6180339887498949))
                .position;
        const double away = std::hypot(at.x, at.y);
        ASSERT_NEAR(std::hypot(away - ring, at.z), tube, 1e-12);
        outside += away > ring;
        top += at.z > 0;
    }
    EXPECT_NEAR(double(outside) / count, 0.5 + tube / (3.141592653589793 * ring), 1e-3);
    EXPECT_NEAR(double(top) / count, 0.5, 1e-3);
}

// The first root of a product of linear factors is its smallest factor's.
TEST(Polynomial, FindsTheFirstRootOfAProduct) {
    Numbers numbers(3);
    for (int i = 0; i < 2000; ++i) {
        std::array<double, 4> roots;
        for (double& root : roots) root = numbers.uniform(-3, 3);
        std::ranges::sort(roots);
        std::array<double, 5> quartic{1};
        for (std::size_t degree = 0; degree < 4; ++degree) {
            for (std::size_t k = degree + 1; k > 0; --k)
                quartic[k] = quartic[k - 1] - roots[degree] * quartic[k];
            quartic[0] *= -roots[degree];
        }
        if (roots[1] - roots[0] < 0.01 || roots[2] - roots[1] < 0.01) continue;
        const auto first = firstRoot(quartic, -4, 4);
        ASSERT_TRUE(first);
        EXPECT_NEAR(*first, roots[0], 1e-6);
        EXPECT_NEAR(*firstRoot(quartic, (roots[0] + roots[1]) / 2, 4), roots[1], 1e-6);
    }
    EXPECT_FALSE(firstRoot(std::array<double, 3>{1, 0, 1}, -10, 10));
}

// Brute force over all boxes finds the same nearest item.
TEST(BoxTree, FindsWhatTryingAllFinds) {
    Numbers numbers(4);
    std::vector<Patch> patches;
    std::vector<BoxTree::Box> boxes;
    for (int i = 0; i < 3000; ++i) {
        const glm::dvec3 at = numbers.onSphere() * numbers.uniform(0, 10);
        patches.push_back(Patch::ball(i % 7 == 0 ? glm::dvec3(1, 2, 3) : at, numbers.uniform(0.01, 0.4)));
        const auto [low, high] = patches.back().bounds();
        boxes.push_back({low, high});
    }
    const BoxTree tree = BoxTree::build(boxes);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
        Ray ray{numbers.onSphere() * numbers.uniform(0, 20), numbers.onSphere()};
        if (i % 5 == 0) ray.direction[i % 3] = 0;
        double brute = 1e9;
        for (const Patch& patch : patches)
            if (const auto hit = intersect(patch, ray, 0, brute)) brute = hit->t;
        double found = 1e9;
        tree.walk(ray, 0, 1e9, [&](std::uint32_t item, double high) {
            if (const auto hit = intersect(patches[item], ray, 0, high)) return found = hit->t;
            return high;
        });
        ASSERT_EQ(found, brute);
        met += brute < 1e9;
    }
    EXPECT_GT(met, 500);
}

}  // namespace
}  // namespace scancast
