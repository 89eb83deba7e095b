// The values of a picture's pixels, one after the other: memory of their own, or memory that somebody lends,
// so that what a GPU has written can be encoded from where it lies. Pipeline: device → **pixels** of a frame
// → encode.
//
// A value: copies of what is lent share it, copies of what is owned have their own. Lent memory never
// changes, and goes back when the last that refers to it goes, on whatever thread that is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace scancast {

template <class T>
class Pixels {
  public:
    using value_type = T;
    using const_iterator = const T*;
    using iterator = const_iterator;

    Pixels() = default;
    Pixels(std::vector<T> values) : own_(std::move(values)) {}
    Pixels(std::initializer_list<T> values) : own_(values) {}
    /// `lender` keeps what `there` refers to as it is; not null.
    static Pixels lent(std::span<const T> there, std::shared_ptr<const void> lender) {
        Pixels pixels;
        pixels.there_ = there;
        pixels.lender_ = std::move(lender);
        return pixels;
    }
    Pixels(const Pixels&) = default;
    Pixels& operator=(const Pixels&) = default;
    /// Nothing is left in `other`.
    Pixels(Pixels&& other) noexcept
        : own_(std::exchange(other.own_, {})),
          there_(std::exchange(other.there_, {})),
          lender_(std::exchange(other.lender_, nullptr)) {}
    Pixels& operator=(Pixels&& other) noexcept {
        own_ = std::exchange(other.own_, {});
        there_ = std::exchange(other.there_, {});
        lender_ = std::exchange(other.lender_, nullptr);
        return *this;
    }
    ~Pixels() = default;

    bool lent() const { return lender_ != nullptr; }
    const T* data() const { return lender_ ? there_.data() : own_.data(); }
    std::size_t size() const { return lender_ ? there_.size() : own_.size(); }
    bool empty() const { return size() == 0; }
    const T& operator[](std::size_t i) const { return data()[i]; }
    const T* begin() const { return data(); }
    const T* end() const { return data() + size(); }

    /// To change them: what is lent is copied first, and given back.
    std::vector<T>& own() {
        if (lender_) {
            own_.assign(begin(), end());
            there_ = {};
            lender_.reset();
        }
        return own_;
    }

    friend bool operator==(const Pixels& a, const Pixels& b) { return std::ranges::equal(a, b); }

  private:
    std::vector<T> own_;  ///< empty while `lender_` is there
    std::span<const T> there_;
    std::shared_ptr<const void> lender_;
};

}  // namespace scancast
