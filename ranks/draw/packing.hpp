// Values as bytes between processes of one program on one kind of machine: numbers as they lie in memory, lists behind their length.
// Values of their function; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ranks/mpi/rank_bytes.hpp"

namespace scancast {

class Packer {
  public:
    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        putBytes(&value, sizeof value);
    }
    template <class T>
    void putAll(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        put(std::uint64_t(values.size()));
        putBytes(values.data(), values.size_bytes());
    }
    void putText(std::string_view text) { putAll(std::span<const char>(text)); }
    void putFlag(bool flag) { put(std::uint8_t(flag)); }
    RankBytes bytes;

  private:
    void putBytes(const void* from, std::size_t size) {
        const auto* const first = static_cast<const std::byte*>(from);
        bytes.insert(bytes.end(), first, first + size);
    }
};

/// Reads what a Packer wrote, or fails: nothing is read or allocated beyond what is there.
class Unpacker {
  public:
    explicit Unpacker(std::span<const std::byte> bytes) : left_(bytes) {}

    template <class T>
    void get(T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        getBytes(&value, sizeof value);
    }
    template <class T>
    void getAll(std::vector<T>& values) {
        std::uint64_t count = 0;
        get(count);
        if (count > left_.size() / sizeof(T)) return fail();
        values.resize(count);
        getBytes(values.data(), count * sizeof(T));
    }
    void getText(std::string& text) {
        std::vector<char> all;
        getAll(all);
        text.assign(all.begin(), all.end());
    }
    /// A byte that is neither 0 nor 1 is no bool.
    void getFlag(bool& flag) {
        std::uint8_t byte = 0;
        get(byte);
        if (byte > 1) return fail();
        flag = byte != 0;
    }
    /// Everything that was asked for was there, and nothing else.
    bool sound() const { return !failed_ && left_.empty(); }
    bool failed() const { return failed_; }
    void fail() { failed_ = true; }

  private:
    void getBytes(void* to, std::size_t size) {
        if (size > left_.size()) return fail();
        if (size > 0) std::memcpy(to, left_.data(), size);
        left_ = left_.subspan(size);
    }
    std::span<const std::byte> left_;
    bool failed_ = false;
};

}  // namespace scancast
