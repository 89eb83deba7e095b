#include "tests/faults/fault_trials.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <random>
#include <string_view>
#include <thread>
#include <tuple>

#include "tests/support/failing_allocation.hpp"

namespace scancast::test {
namespace {

TrialCount counted;

std::uint64_t seed() {
    const char* const text = std::getenv("SCANCAST_FAULT_SEED");
    return text != nullptr ? std::strtoull(text, nullptr, 10) : 1;
}

std::string repeatCommand(const std::vector<Fault>& faults) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    return "repeat it by: SCANCAST_FAULT=" + nameOf(faults) +
           " test_faults --gtest_filter=" + test->test_suite_name() + "." + test->name();
}

Expected<std::string> runCleanly(const Scene& scene) {
    if (scene.before) scene.before();
    return scene.run();
}

/// Of the trial that runs, for who is killed by it.
std::array<char, 400> lastCommand{};

extern "C" void sayLastCommand(int signal) {
    constexpr std::string_view start = "\nThe program ended; ";
    std::ignore = ::write(STDERR_FILENO, start.data(), start.size());
    std::ignore = ::write(STDERR_FILENO, lastCommand.data(), std::strlen(lastCommand.data()));
    std::ignore = ::write(STDERR_FILENO, "\n", 1);
    ::signal(signal, SIG_DFL);
    ::raise(signal);
}

void remember(const std::string& command) {
    command.copy(lastCommand.data(), lastCommand.size() - 1);
    lastCommand[std::min(command.size(), lastCommand.size() - 1)] = '\0';
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS}) ::signal(signal, sayLastCommand);
}

/// What a scene throws because memory ran out is its way to refuse: whoever calls it stands behind guarded().
Expected<std::string> runWithoutMemory(const Scene& scene) {
    try {
        return scene.run();
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, "There was no memory.");
    }
}

template <class Condition>
bool soon(Condition condition) {
    for (int i = 0; i < 2000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

bool mustGoOn(const std::vector<Fault>& faults) {
    return std::ranges::all_of(faults, [](const Fault& fault) {
        return fault.effect == Fault::Effect::Short || fault.effect == Fault::Effect::Jumps ||
               (fault.effect == Fault::Effect::Fails && fault.error == EINTR && fault.call != Call::Allocate);
    });
}

}  // namespace

void FaultTrials::TearDownTestSuite() {
    const auto* suite = testing::UnitTest::GetInstance()->current_test_suite();
    std::printf("%s: %llu faults injected, %llu survived\n", suite->name(),
                static_cast<unsigned long long>(counted.injected),
                static_cast<unsigned long long>(counted.survived));
    counted = {};
}

void FaultTrials::prepare(const Scene& scene) {
    if (prepared_ == &scene) return;
    prepared_ = &scene;
    for (int i = 0; i < 3; ++i) {
        const auto result = runCleanly(scene);
        ASSERT_TRUE(result) << "without any fault: " << result.error().message;
        ASSERT_TRUE(i == 0 || *result == right_) << "the scene is not the same each time";
        right_ = *result;
    }
    descriptors_ = openDescriptors();
    live_ = liveAllocations();
}

std::uint64_t FaultTrials::callsOf(const Scene& scene, Call call) {
    if (scene.before) scene.before();
    const Faults none({}, scene.whose, scene.leastAllocation);
    const auto result = scene.run();
    EXPECT_TRUE(result);
    return none.calls(call);
}

std::vector<std::uint64_t> FaultTrials::chosen(std::uint64_t calls, std::uint64_t atMost) const {
    std::vector<std::uint64_t> all(calls);
    for (std::uint64_t i = 0; i < calls; ++i) all[i] = i + 1;
    if (calls <= atMost) return all;
    std::mt19937_64 random(seed());
    std::shuffle(all.begin() + std::ptrdiff_t(atMost / 2), all.end(), random);
    all.resize(atMost);
    return all;
}

bool FaultTrials::repeated(const Scene& scene) {
    const char* const text = std::getenv("SCANCAST_FAULT");
    if (text == nullptr) return false;
    const auto faults = parseFaults(text);
    if (!faults) {
        ADD_FAILURE() << "SCANCAST_FAULT: " << text << " names no fault; such as read:3:EIO";
        return true;
    }
    tryOne(scene, *faults);
    return true;
}

bool FaultTrials::tryOne(const Scene& scene, const std::vector<Fault>& faults) {
    prepare(scene);
    if (HasFatalFailure()) return false;
    const bool failedBefore = HasFailure();
    remember(repeatCommand(faults));
    SCOPED_TRACE(repeatCommand(faults));
    bool happened = false;
    Expected<std::string> result = fail(ErrorCode::Internal, "");
    if (scene.before) scene.before();
    {
        const Faults armed(faults, scene.whose, scene.leastAllocation);
        result = runWithoutMemory(scene);
        happened = armed.happened() > 0 || faults.empty();
    }
    if (result) {
        EXPECT_TRUE(*result == right_) << "something else came out";
    } else {
        EXPECT_FALSE(result.error().message.empty());
        EXPECT_FALSE(mustGoOn(faults)) << "what is no failure was one: " << result.error().message;
        EXPECT_NE(result.error().code, ErrorCode::Internal) << result.error().message;
    }
    if (scene.after) scene.after(faults, result);
    const auto clean = runCleanly(scene);
    EXPECT_TRUE(clean) << "the next run: " << clean.error().message;
    if (clean) {
        EXPECT_TRUE(*clean == right_) << "the next run comes out otherwise";
    }
    expectNothingLeft(scene, faults);
    if (!happened) return false;
    ++counted.injected;
    if (failedBefore || !HasFailure()) ++counted.survived;
    return true;
}

// What threads of libraries keep for themselves may grow once; what grows with each fault is lost.
void FaultTrials::expectNothingLeft(const Scene& scene, const std::vector<Fault>& faults) {
    EXPECT_TRUE(soon([&] { return openDescriptors() <= descriptors_; }))
        << openDescriptors() << " descriptors are open, it were " << descriptors_;
    // A failure is memory, too.
    for (int repeats = 0; !scene.livesOn && !HasFailure() && liveAllocations() > live_; ++repeats) {
        if (repeats == 4) {
            ADD_FAILURE() << "memory is lost with each of these faults";
            return;
        }
        live_ = liveAllocations();
        if (scene.before) scene.before();
        {
            const Faults armed(faults, scene.whose, scene.leastAllocation);
            std::ignore = runWithoutMemory(scene);
        }
        if (scene.after) scene.after(faults, fail(ErrorCode::Io, "not looked at"));
        std::ignore = runCleanly(scene);
    }
}

void FaultTrials::failEach(const Scene& scene, Call call, const std::vector<int>& errors, bool isInterrupted,
                           bool isShort, std::uint64_t atMost) {
    prepare(scene);
    if (HasFatalFailure() || repeated(scene)) return;
    std::vector<Fault> kinds;
    for (const int error : errors) kinds.push_back({.call = call, .error = error});
    for (const int error : errors)
        if (error == ENOSPC || (error == EMFILE && call != Call::Accept))  // else nobody is ever let in
            kinds.push_back({.call = call, .effect = Fault::Effect::Stays, .error = error});
    if (isInterrupted) kinds.push_back({.call = call, .error = EINTR});
    if (isShort) kinds.push_back({.call = call, .effect = Fault::Effect::Short});
    const std::uint64_t calls = callsOf(scene, call);
    EXPECT_GT(calls, 0U) << "the scene makes no such call";
    for (Fault& fault : kinds)
        for (const std::uint64_t nth : chosen(calls, atMost)) {
            fault.nth = nth;
            tryOne(scene, {fault});
            if (HasFailure()) return;
        }
}

void FaultTrials::killEach(const Scene& scene, std::uint64_t atMost) {
    prepare(scene);
    if (HasFatalFailure() || repeated(scene)) return;
    for (const Call call : {Call::Write, Call::Rename})
        for (const std::uint64_t nth : chosen(callsOf(scene, call), atMost)) {
            tryOne(scene, {{.call = call, .nth = nth, .effect = Fault::Effect::Kills}});
            if (HasFailure()) return;
        }
}

void FaultTrials::failAllocations(const Scene& scene, std::uint64_t atMost) {
    prepare(scene);
    if (HasFatalFailure() || repeated(scene)) return;
    for (const std::uint64_t nth : chosen(callsOf(scene, Call::Allocate), atMost)) {
        tryOne(scene, {{.call = Call::Allocate, .nth = nth}});
        if (HasFailure()) return;
    }
}

void FaultTrials::failTogether(const Scene& scene, const std::vector<Call>& calls, std::uint64_t trials) {
    prepare(scene);
    if (HasFatalFailure() || repeated(scene)) return;
    std::vector<std::uint64_t> made;
    for (const Call call : calls) made.push_back(std::max<std::uint64_t>(1, callsOf(scene, call)));
    std::mt19937_64 random(seed());
    constexpr std::array<int, 4> errors{EIO, ENOSPC, EMFILE, EINTR};
    for (std::uint64_t trial = 0; trial < trials; ++trial) {
        std::vector<Fault> faults(2 + random() % 3);
        for (Fault& fault : faults) {
            const std::size_t which = random() % calls.size();
            fault.call = calls[which];
            fault.nth = 1 + random() % made[which];
            if (fault.call == Call::Allocate) continue;
            fault.error = errors[random() % errors.size()];
            if (fault.call == Call::Status && fault.error == EINTR) fault.error = EIO;  // it never waits
        }
        tryOne(scene, faults);
        if (HasFailure()) return;
    }
}

}  // namespace scancast::test
