// Lets one allocation of the program under test fail, so that what becomes of it can be tried out for every
// one. Linked into a test program, failing_allocation.cpp replaces its operator new.
#pragma once

#include <cstddef>
#include <cstdint>

namespace scancast::test {

/// While it lives, the n-th allocation (from 1; 0 = none, only counted) of at least that size fails, of those that threads other than
/// the one that made this make - or, where it is not spared, that one, too. One at a time.
class FailingAllocation {
  public:
    explicit FailingAllocation(std::uint64_t nth, std::size_t atLeast = 0, bool spareMaker = true);
    ~FailingAllocation();
    FailingAllocation(const FailingAllocation&) = delete;
    FailingAllocation& operator=(const FailingAllocation&) = delete;
    bool happened() const;
    /// Allocations of that size up to now: those that were to fail or not.
    std::uint64_t calls() const;

  private:
    const std::int64_t nth_;
};

/// Blocks of memory that operator new has given and that have not come back.
std::int64_t liveAllocations();

}  // namespace scancast::test
