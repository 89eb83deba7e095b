// Tries a scene - a small piece of work, such as opening and drawing a cloud file - with one call of the system after
// the other failing, and holds against it what must be true after any of them:
//   - what comes out is right to the byte, or an error with a sentence; what was interrupted, or moved fewer bytes, is right;
//   - the next run, without a fault, is right;
//   - no descriptor is open that was not before, and no memory is held that is not each time.
// A trial that fails prints the command that repeats it alone. One thread.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "tests/support/system_faults.hpp"

namespace scancast::test {

struct Scene {
    /// What comes out, as bytes. Exceptions count as refusals only where memory ran out.
    std::function<Expected<std::string>()> run;
    /// Before each run, without a fault.
    std::function<void()> before = {};
    /// After each fault and before the run that has none: EXPECTs of the scene's own, such as of files.
    std::function<void(const std::vector<Fault>& faults, const Expected<std::string>& result)> after = {};
    Whose whose = Whose::Everybodys;
    /// Smaller allocations are let through, as by the reserve that `serve` keeps: where one's absence would end a thread
    /// of a library.
    std::size_t leastAllocation = 0;
    /// It is a server that goes on between runs, and may remember them: its memory is looked at when it has ended.
    bool livesOn = false;
};

struct TrialCount {
    std::uint64_t injected = 0, survived = 0;
};

/// Scenes are members of the fixture, or of a test: they are known by their address.
class FaultTrials : public testing::Test {
  protected:
    /// With how many of each kind of call at most: all where there are no more, else the first half of that, and others by
    /// the seed (SCANCAST_FAULT_SEED).
    static constexpr std::uint64_t most = 120;

    /// Each call of that kind that the scene makes, with each of these effects.
    void failEach(const Scene& scene, Call call, const std::vector<int>& errors, bool isInterrupted = false,
                  bool isShort = false, std::uint64_t atMost = most);
    void killEach(const Scene& scene, std::uint64_t atMost = most);
    void failAllocations(const Scene& scene, std::uint64_t atMost = most);
    /// Two to four faults at once, chosen by seeds, among calls of these kinds.
    void failTogether(const Scene& scene, const std::vector<Call>& calls, std::uint64_t trials);
    /// Once; false when the faults did not happen. None = the scene has its own, and must come out right with it.
    bool tryOne(const Scene& scene, const std::vector<Fault>& faults);

    static void TearDownTestSuite();
    /// Runs it until it is the same each time; what follows does so by itself.
    void prepare(const Scene& scene);

  private:
    void expectNothingLeft(const Scene& scene, const std::vector<Fault>& faults);
    std::vector<std::uint64_t> chosen(std::uint64_t calls, std::uint64_t atMost) const;
    std::uint64_t callsOf(const Scene& scene, Call call);
    /// What the environment says is to be tried alone (SCANCAST_FAULT); true when that has been done.
    bool repeated(const Scene& scene);

    const Scene* prepared_ = nullptr;
    std::string right_;
    std::size_t descriptors_ = 0;
    std::int64_t live_ = 0;
};

}  // namespace scancast::test
