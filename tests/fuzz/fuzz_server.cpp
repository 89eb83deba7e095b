// The whole server: what hostile clients say and when, who comes and goes, what breaks meanwhile - a trace
// (tests/simulation/trace.hpp), played against the scheduler and sessions in virtual time.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/simulation/trace.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view trace(reinterpret_cast<const char*>(data), size);
    if (const auto violation = scancast::simulation::playTrace(trace)) {
        std::fprintf(stderr, "%s\n", violation->c_str());
        std::abort();
    }
    return 0;
}
