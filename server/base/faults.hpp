// What the server does with exceptions that reach the edge of a thread or a callback: the request fails with
// its problem, the thread goes on, and the log says so - once for each sentence, and again when it has
// happened ten, a hundred, a thousand times, so that a fault that comes with every frame does not fill a
// disk.
//
// *Thread safety*: every function may be called from any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "protocol/error.hpp"
#include "threads/guarded.hpp"

namespace scancast {

class FaultLog {
  public:
    static constexpr std::size_t mostSentences = 64;  ///< that are told apart; what is beyond counts as one

    explicit FaultLog(std::function<void(const std::string& line)> write) : write_(std::move(write)) {}
    void report(const Error& fault) noexcept;

  private:
    std::uint64_t count(const std::string& sentence);

    const std::function<void(const std::string&)> write_;
    std::mutex mutex_;
    std::map<std::string, std::uint64_t> times_;
};

/// To the server's log.
void reportFault(const Error& fault) noexcept;

/// guarded(), with what is thrown reported.
template <class Work>
auto contained(std::string_view who, Work&& work) {
    return guarded(who, std::forward<Work>(work), [](const Error& fault) { reportFault(fault); });
}

}  // namespace scancast
