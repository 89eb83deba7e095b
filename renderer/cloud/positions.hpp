// Where the points of a batch are: float64 coordinates, or whole steps of a grid, as most formats keep them. Steps travel
// to the builder as they are: 12 bytes a point, and exact. Plain values. Pipeline: file → **import** → octree.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace scancast {

/// A position as a format keeps it: steps of its grid, in x, y, z.
using GridSteps = std::array<std::int32_t, 3>;

/// What steps mean: origin + step · number, computed in float64.
struct StepGrid {
    glm::dvec3 origin{0};
    glm::dvec3 step{1};  ///< each > 0

    bool operator==(const StepGrid& o) const { return origin == o.origin && step == o.step; }
    glm::dvec3 at(const GridSteps& steps) const {
        return origin + step * glm::dvec3(steps[0], steps[1], steps[2]);
    }
    /// No coordinate on it is farther than this from 0.
    double reach() const {
        double most = 0;
        for (int a = 0; a < 3; ++a) most = std::max(most, std::abs(origin[a]) + 0x1p31 * step[a]);
        return most;
    }
    /// As many steps lie between the origins of two grids: what has the number n here has n + that in the `other`. Nothing
    /// if their steps differ or the origin of one is no position of the other; then positions say what is meant.
    std::optional<std::array<std::int64_t, 3>> stepsIn(const StepGrid& other) const;
};

/// Either doubles() or steps(): reading gives file coordinates in both cases.
class Positions {
  public:
    using value_type = glm::dvec3;

    Positions() = default;
    Positions(std::vector<glm::dvec3> doubles) : doubles_(std::move(doubles)) {}

    bool areSteps() const { return grid_.has_value(); }
    std::size_t size() const { return areSteps() ? steps_.size() : doubles_.size(); }
    bool empty() const { return size() == 0; }
    glm::dvec3 operator[](std::size_t i) const { return areSteps() ? grid_->at(steps_[i]) : doubles_[i]; }
    glm::dvec3 front() const { return (*this)[0]; }
    glm::dvec3 back() const { return (*this)[size() - 1]; }
    /// Calls `f` with each position, in order: for loops that must not decide again at every point.
    template <class F>
    void forEach(F f) const {
        if (areSteps())
            for (const GridSteps& s : steps_) f(grid_->at(s));
        else
            for (const glm::dvec3& p : doubles_) f(p);
    }
    bool operator==(const Positions& o) const {
        return size() == o.size() && std::equal(begin(), end(), o.begin());
    }

    /// Only if areSteps().
    const StepGrid& grid() const { return *grid_; }
    std::span<const GridSteps> asSteps() const { return steps_; }
    /// Only if not areSteps().
    std::span<const glm::dvec3> asDoubles() const { return doubles_; }

    /// To be filled and changed: float64, which steps that are there become.
    std::vector<glm::dvec3>& doubles() {
        if (areSteps()) {
            doubles_.assign(begin(), end());
            steps_.clear();
            grid_.reset();
        }
        return doubles_;
    }
    /// To be filled and changed: steps of this grid. What is there stays if it is that already; else it goes.
    std::vector<GridSteps>& steps(const StepGrid& grid) {
        if (grid_ != grid) {
            doubles_.clear();
            steps_.clear();
            grid_ = grid;
        }
        return steps_;
    }

    /// Keeps the memory and the kind.
    void clear() {
        doubles_.clear();
        steps_.clear();
    }
    // Of doubles():
    void reserve(std::size_t count) { doubles().reserve(count); }
    void push_back(const glm::dvec3& p) { doubles().push_back(p); }
    template <class... Args>
    void emplace_back(Args&&... args) {
        doubles().emplace_back(std::forward<Args>(args)...);
    }

    /// Positions as values; as random as an iterator can be.
    class Iterator {
      public:
        using iterator_category = std::random_access_iterator_tag;
        using value_type = glm::dvec3;
        using difference_type = std::ptrdiff_t;
        using pointer = const glm::dvec3*;
        using reference = glm::dvec3;

        Iterator() = default;
        Iterator(const Positions& of, std::ptrdiff_t at) : of_(&of), at_(at) {}
        glm::dvec3 operator*() const { return (*of_)[std::size_t(at_)]; }
        glm::dvec3 operator[](std::ptrdiff_t n) const { return *(*this + n); }
        Iterator& operator++() { return *this += 1; }
        Iterator& operator--() { return *this += -1; }
        Iterator operator++(int) { return std::exchange(*this, *this + 1); }
        Iterator operator--(int) { return std::exchange(*this, *this - 1); }
        Iterator& operator+=(std::ptrdiff_t n) { return at_ += n, *this; }
        Iterator& operator-=(std::ptrdiff_t n) { return at_ -= n, *this; }
        friend Iterator operator+(Iterator i, std::ptrdiff_t n) { return i += n; }
        friend Iterator operator+(std::ptrdiff_t n, Iterator i) { return i += n; }
        friend Iterator operator-(Iterator i, std::ptrdiff_t n) { return i -= n; }
        friend std::ptrdiff_t operator-(const Iterator& a, const Iterator& b) { return a.at_ - b.at_; }
        bool operator==(const Iterator& o) const { return at_ == o.at_; }
        auto operator<=>(const Iterator& o) const { return at_ <=> o.at_; }

      private:
        const Positions* of_ = nullptr;
        std::ptrdiff_t at_ = 0;
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, std::ptrdiff_t(size())}; }

  private:
    std::vector<glm::dvec3> doubles_;
    std::vector<GridSteps> steps_;
    std::optional<StepGrid> grid_;  ///< of steps_
};

/// Smallest and largest coordinates; of none, infinities the wrong way round.
std::array<glm::dvec3, 2> boundsOf(const Positions& positions);

}  // namespace scancast
