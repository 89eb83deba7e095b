#include "server/base/memory_reserve.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace scancast {
namespace {

constexpr std::size_t reserveBytes = 1 << 20;

std::atomic<void*> reserve{nullptr};
std::atomic<bool> kept{false};

// operator new tries again when this returns.
void giveFree() {
    void* const memory = reserve.exchange(nullptr);
    if (memory == nullptr) throw std::bad_alloc();
    std::free(memory);
}

}  // namespace

void keepMemoryReserve() {
    kept = true;
    refillMemoryReserve();
    std::set_new_handler(giveFree);
}

void refillMemoryReserve() noexcept {
    if (kept && reserve == nullptr) std::free(reserve.exchange(std::malloc(reserveBytes)));
}

}  // namespace scancast
