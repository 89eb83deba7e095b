// Lets one allocation of the program under test fail, so that what becomes of it can be tried out for every
// one. Linked into a test program, failing_allocation.cpp replaces its operator new.
#pragma once

#include <cstddef>
#include <cstdint>

namespace scancast::test {

/// While it lives, the n-th allocation (from 1) of at least that size fails, of those that threads other than
/// the one that made this make. One at a time.
class FailingAllocation {
  public:
    explicit FailingAllocation(std::uint64_t nth, std::size_t atLeast = 0);
    ~FailingAllocation();
    FailingAllocation(const FailingAllocation&) = delete;
    FailingAllocation& operator=(const FailingAllocation&) = delete;
    bool happened() const;
};

}  // namespace scancast::test
