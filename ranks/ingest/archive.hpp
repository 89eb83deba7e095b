// Values as bytes from one rank to another of the same program: in the order in which they are said, without names. Plain values; any
// thread. What comes is checked as far as it could harm: no length is believed that the bytes do not have.
#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "ranks/mpi/communicator.hpp"

namespace scancast {

class BytesOut {
  public:
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(const T& value) {
        const auto* bytes = reinterpret_cast<const std::byte*>(&value);
        bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
    }
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(const std::vector<T>& values) {
        (*this)(std::uint64_t(values.size()));
        const auto* bytes = reinterpret_cast<const std::byte*>(values.data());
        bytes_.insert(bytes_.end(), bytes, bytes + values.size() * sizeof(T));
    }
    void operator()(const std::string& text) { (*this)(std::vector<char>(text.begin(), text.end())); }

    RankBytes take() { return std::move(bytes_); }

  private:
    RankBytes bytes_;
};

class BytesIn {
  public:
    explicit BytesIn(std::span<const std::byte> bytes) : rest_(bytes) {}

    /// What is not there becomes nothing, and isSound() says so.
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(T& value) {
        if (!has(sizeof value)) return;
        std::memcpy(&value, rest_.data(), sizeof value);
        rest_ = rest_.subspan(sizeof value);
    }
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void operator()(std::vector<T>& values) {
        std::uint64_t size = 0;
        (*this)(size);
        values.clear();
        if (size > rest_.size() / sizeof(T)) isSound_ = false;
        if (!isSound_) return;
        values.resize(size);
        if (size > 0) std::memcpy(values.data(), rest_.data(), size * sizeof(T));
        rest_ = rest_.subspan(size * sizeof(T));
    }
    void operator()(std::string& text) {
        std::vector<char> letters;
        (*this)(letters);
        text.assign(letters.begin(), letters.end());
    }
    template <class T>
    T get() {
        T value{};
        (*this)(value);
        return value;
    }

    bool isSound() const { return isSound_; }
    bool isAtEnd() const { return rest_.empty(); }
    /// Internal unless all of it was there, and nothing else.
    Expected<void> finish() const {
        if (isSound_ && rest_.empty()) return {};
        return fail(ErrorCode::Internal, "A rank was sent something that it does not understand.");
    }

  private:
    bool has(std::size_t bytes) {
        if (rest_.size() < bytes) isSound_ = false;
        return isSound_;
    }

    std::span<const std::byte> rest_;
    bool isSound_ = true;
};

}  // namespace scancast
