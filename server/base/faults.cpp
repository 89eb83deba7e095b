#include "server/base/faults.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "server/base/memory_reserve.hpp"

namespace scancast {
namespace {

bool isTelling(std::uint64_t times) {
    while (times >= 10 && times % 10 == 0) times /= 10;
    return times == 1;
}

}  // namespace

std::uint64_t FaultLog::count(const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    const bool known = times_.size() < mostSentences || times_.contains(sentence);
    return ++times_[known ? sentence : std::string("others")];
}

void FaultLog::report(const Error& fault) noexcept {
    try {
        const std::uint64_t times = count(fault.message);
        if (!isTelling(times)) return;
        write_(times == 1 ? fault.message : fmt::format("{} ({} times by now)", fault.message, times));
    } catch (...) {
        std::fputs("There is no memory left even to log what failed.\n", stderr);
    }
}

void reportFault(const Error& fault) noexcept {
    refillMemoryReserve();
    static FaultLog log([](const std::string& line) { spdlog::error("{}", line); });
    log.report(fault);
}

}  // namespace scancast
