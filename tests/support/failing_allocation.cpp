#include "tests/support/failing_allocation.hpp"

#include <pthread.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::int64_t> left{0};  // until the one that fails; 0 or less = none
std::atomic<bool> armed{false}, failed{false};
std::atomic<std::size_t> least{0};
std::atomic<pthread_t> spared{};
std::atomic<bool> sparesNobody{false};
std::atomic<std::int64_t> live{0};

void* counted(void* memory) {
    if (memory != nullptr) live.fetch_add(1, std::memory_order_relaxed);
    return memory;
}

void release(void* memory) {
    if (memory != nullptr) live.fetch_sub(1, std::memory_order_relaxed);
    std::free(memory);
}

void* allocate(std::size_t size, std::size_t alignment) {
    if (armed && size >= least && (sparesNobody || pthread_self() != spared) && left.fetch_sub(1) == 1) {
        failed = true;
        return nullptr;
    }
    if (alignment <= alignof(std::max_align_t)) return counted(std::malloc(size == 0 ? 1 : size));
    return counted(std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment));
}

void* allocateOrThrow(std::size_t size, std::size_t alignment = 1) {
    while (true) {
        void* const memory = allocate(size, alignment);
        if (memory != nullptr) return memory;
        const std::new_handler handler = std::get_new_handler();
        if (handler == nullptr) throw std::bad_alloc();
        handler();  // what it gave free is enough, the second time
    }
}

}  // namespace

void* operator new(std::size_t size) {
    return allocateOrThrow(size);
}
void* operator new[](std::size_t size) {
    return allocateOrThrow(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocateOrThrow(size, std::size_t(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return allocateOrThrow(size, std::size_t(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return allocate(size, 1);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
    return allocate(size, 1);
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete[](void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    release(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    release(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    release(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
    release(memory);
}

namespace scancast::test {

FailingAllocation::FailingAllocation(std::uint64_t nth, std::size_t atLeast, bool spareMaker)
    : nth_(std::int64_t(nth)) {
    sparesNobody = !spareMaker;
    spared = pthread_self();
    least = atLeast;
    failed = false;
    left = nth_;
    armed = true;
}

FailingAllocation::~FailingAllocation() {
    armed = false;
}

bool FailingAllocation::happened() const {
    return failed;
}

std::uint64_t FailingAllocation::calls() const {
    return std::uint64_t(nth_ - left);
}

std::int64_t liveAllocations() {
    return live;
}

}  // namespace scancast::test
