// The name under which a file is written before it is complete: what is not finished vanishes again, and the final
// name appears with all of the file or never. Move-only; used by one thread at a time.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>

namespace scancast {

class UnfinishedName {
  public:
    UnfinishedName() = default;
    explicit UnfinishedName(std::string name) : name_(std::move(name)) {}
    UnfinishedName(UnfinishedName&& other) noexcept : name_(std::exchange(other.name_, {})) {}
    UnfinishedName& operator=(UnfinishedName&& other) noexcept {
        if (this != &other) remove(std::exchange(other.name_, {}));
        return *this;
    }
    ~UnfinishedName() { remove({}); }

    /// Empty = there is none: nothing was begun, or it is finished, or given up.
    const std::string& name() const { return name_; }
    explicit operator bool() const { return !name_.empty(); }

    /// Replaces whatever has the final name. Returns 0, or the system's error number; the file is then still
    /// unfinished.
    int become(const std::string& finalName) {
        if (std::rename(name_.c_str(), finalName.c_str()) != 0) return errno;
        name_.clear();
        return 0;
    }
    /// Nothing was made under this name: there is nothing to remove.
    void forget() { name_.clear(); }

  private:
    void remove(std::string next) noexcept {
        if (!name_.empty()) ::unlink(name_.c_str());
        name_ = std::move(next);
    }

    std::string name_;
};

}  // namespace scancast
