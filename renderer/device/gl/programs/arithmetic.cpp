#include "renderer/device/gl/programs/arithmetic.hpp"

#include <spdlog/spdlog.h>

#include <bit>
#include <cmath>
#include <vector>

#include "renderer/device/gl/programs/programs.hpp"

namespace scancast::gl {
namespace {

constexpr std::uint32_t probes = 8192, probesPerGroup = 64;

struct Probe {
    std::uint32_t a, b;  ///< bits of floats > 0
};

/// Mantissas as they come; exponents as pictures have them, and every fourth near the borders of what is
/// corrected. Ever the same.
std::vector<Probe> makeProbes() {
    std::vector<Probe> all(probes);
    std::uint64_t state = 0x853c49e6748fea9b;
    const auto next = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::uint32_t>(state >> 32);
    };
    for (std::uint32_t i = 0; i < probes; ++i) {
        const std::uint32_t range = i % 4 == 0 ? 94 : 32;
        const auto number = [&] { return (127 - range / 2 + next() % range) << 23 | next() >> 9; };
        all[i] = {number(), number()};
    }
    return all;
}

std::array<std::uint32_t, 4> expectedOf(const Probe& probe) {
    const float a = std::bit_cast<float>(probe.a), b = std::bit_cast<float>(probe.b);
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    return {bits(a / b), bits(1.0f / b), bits(std::sqrt(a)), bits(static_cast<float>(probe.a * 977u))};
}

}  // namespace

std::array<Define, 2> definesOf(const Arithmetic& arithmetic) {
    return {Define{"ROUNDING", static_cast<int>(arithmetic.rounding)}, Define{"ROUGH", arithmetic.rough}};
}

Expected<bool> isExact(const GlFunctions& gl, const std::filesystem::path& programFolder,
                       const Arithmetic& arithmetic) {
    const std::vector<Probe> given = makeProbes();
    std::vector<std::array<std::uint32_t, 4>> found(given.size());
    Programs programs(gl, programFolder, arithmetic);
    const auto program = programs.get("probe_arithmetic.comp", {});
    if (!program) return passOn(program);
    Buffer in(gl, "numbers to round"), out(gl, "rounded numbers");
    if (auto ok = in.write(std::as_bytes(std::span(given))); !ok) return passOn(ok);
    if (auto ok = out.reserve(found.size() * sizeof found[0]); !ok) return passOn(ok);
    in.bindStorage(0);
    out.bindStorage(1);
    (*program)->use();
    gl.DispatchCompute(probes / probesPerGroup, 1, 1);
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    if (auto ok = waitForGpu(gl); !ok) return passOn(ok);
    out.read(std::as_writable_bytes(std::span(found)));
    if (auto ok = checkErrors(gl, "finding out how the driver rounds"); !ok) return passOn(ok);
    for (std::size_t i = 0; i < given.size(); ++i) {
        if (found[i] == expectedOf(given[i])) continue;
        spdlog::debug("Rounding {}: of {:08x} and {:08x} the GPU finds {:08x} {:08x} {:08x} {:08x}.",
                      static_cast<int>(arithmetic.rounding), given[i].a, given[i].b, found[i][0], found[i][1],
                      found[i][2], found[i][3]);
        return false;
    }
    return true;
}

Expected<Arithmetic> findArithmetic(const GlFunctions& gl, const std::filesystem::path& programFolder,
                                    bool rough) {
    for (const Rounding rounding : {Rounding::Own, Rounding::ByFma, Rounding::BySplitting}) {
        const Arithmetic arithmetic{rounding, true, rough};
        const auto exact = isExact(gl, programFolder, arithmetic);
        if (!exact) return passOn(exact);
        if (*exact) return arithmetic;
    }
    spdlog::warn(
        "This OpenGL driver rounds quotients, roots or integers as no correction here makes right: its "
        "pictures may "
        "differ from the cpu device's in places.");
    return Arithmetic{Rounding::ByFma, false, rough};
}

}  // namespace scancast::gl
