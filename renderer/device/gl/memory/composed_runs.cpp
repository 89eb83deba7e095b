#include "renderer/device/gl/memory/composed_runs.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace scancast::gl {
namespace {

constexpr int runsPerGroup = 64;
constexpr std::size_t probedRuns = 2048;

/// Numbers in [0, 1) with all their bits. Ever the same.
class Numbers {
  public:
    double next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 11) * 0x1p-53;
    }
    double around(double magnitude) { return (next() - 0.5) * 2 * magnitude; }

  private:
    std::uint64_t state_ = 0x9e3779b97f4a7c15;
};

/// Steps of a tenth of a micrometre up to metres; places up to millions of steps away, and some that are too large.
std::vector<RunFacts> factsToProbe() {
    std::vector<RunFacts> all(probedRuns);
    Numbers numbers;
    for (std::size_t i = 0; i < probedRuns; ++i) {
        const double far = std::exp2(numbers.around(20)), fine = std::exp2(-23 * numbers.next());
        const double beyond = i % 64 == 63 ? 1e26 : 1;
        RunFacts& facts = all[i];
        facts.corner = {numbers.around(far) * beyond, numbers.around(far), numbers.around(far), fine};
        facts.steps = {fine * numbers.next(), fine * numbers.next(), 0, 0};
        facts.factors.w = static_cast<float>(numbers.next());
    }
    return all;
}

/// No rotation; but neither do doubles know what they multiply.
ComposeParams paramsToProbe() {
    Numbers numbers;
    ComposeParams params{};
    for (auto& column : params.columns) column = {numbers.around(1), numbers.around(1), numbers.around(1), 0};
    const double pixelsPerUnit = 1000 * (1 + numbers.next());
    params.scale = {pixelsPerUnit, -pixelsPerUnit, -1, largestCoefficient};
    params.sizes = {1, numbers.next(), 0, numbers.next()};
    for (int i = 0; i < mostSplatPasses; ++i) params.sizes[i] = static_cast<float>(params.sizes[i]);
    params.count.x = probedRuns;
    return params;
}

Expected<std::vector<RunParams>> composedByDriver(ScreenShaders& shaders, const std::vector<RunFacts>& given,
                                                  const ComposeParams& params) {
    const GlFunctions& gl = shaders.functions();
    std::vector<RunParams> found(given.size());
    Buffer facts(gl, "facts to compose"), runs(gl, "composed runs");
    if (auto ok = facts.write(std::as_bytes(std::span(given))); !ok) return passOn(ok);
    if (auto ok = runs.reserve(std::as_bytes(std::span(found)).size()); !ok) return passOn(ok);
    if (auto ok = composeOnGpu(shaders, facts, params, runs); !ok) return passOn(ok);
    if (auto ok = waitForGpu(gl); !ok) return passOn(ok);
    runs.read(std::as_writable_bytes(std::span(found)));
    if (auto ok = checkErrors(gl, "finding out how the driver rounds doubles"); !ok) return passOn(ok);
    return found;
}

}  // namespace

ComposeParams composeParams(const Viewpoint& viewpoint, std::span<const SplatPass> passes, std::size_t runs) {
    ComposeParams params{};
    for (int c = 0; c < 4; ++c) params.columns[c] = viewpoint.cloudToView[c];
    params.scale = {viewpoint.pixelsPerUnit, -viewpoint.pixelsPerUnit, -1, largestCoefficient};
    for (std::size_t i = 0; i < passes.size(); ++i)
        if (!ofSurfels(passes[i])) params.sizes[static_cast<int>(i)] = passes[i].scale;
    params.count.x = static_cast<std::uint32_t>(runs);
    return params;
}

RunParams composed(const RunFacts& facts, const ComposeParams& params) {
    RunParams run{};
    const glm::dmat4 cloudToView(params.columns[0], params.columns[1], params.columns[2], params.columns[3]);
    const glm::dvec3 step(facts.corner.w, facts.steps.x, facts.steps.y);
    float rows[3][4] = {};
    if (composeToPicture(facts.corner, step, cloudToView, params.scale.x, rows)) {
        for (int r = 0; r < 3; ++r) run.toPicture[r] = {rows[r][0], rows[r][1], rows[r][2], rows[r][3]};
    } else {
        run.toPicture[2].w = -1;
    }
    run.clipMin = facts.clipMin;
    run.clipMax = facts.clipMax;
    for (int i = 0; i < mostSplatPasses; ++i) {
        const double factor =
            spriteFactor(facts.factors.w, static_cast<float>(params.sizes[i]), params.scale.x);
        run.sizeFactors[i] = static_cast<float>(std::clamp(factor, 0.0, 1e30));
    }
    run.factors = facts.factors;
    run.color = facts.color;
    return run;
}

Expected<void> composeOnGpu(ScreenShaders& shaders, const Buffer& facts, const ComposeParams& params,
                            const Buffer& runs) {
    if (params.count.x == 0) return {};
    if (auto ok = shaders.set(params); !ok) return ok;
    facts.bindStorage(binding::composeRuns::facts);
    runs.bindStorage(binding::runs);
    return shaders.run("compose_runs.comp", tilesOf(static_cast<int>(params.count.x), runsPerGroup), 1);
}

Expected<bool> composesExactly(ScreenShaders& shaders) {
    const std::vector<RunFacts> given = factsToProbe();
    const ComposeParams params = paramsToProbe();
    const auto found = composedByDriver(shaders, given, params);
    if (!found && found.error().code == ErrorCode::DeviceLost) return passOn(found);
    if (!found) {
        spdlog::debug("Runs are composed by the host: {}", found.error().message);
        return false;
    }
    for (std::size_t i = 0; i < given.size(); ++i) {
        const RunParams expected = composed(given[i], params);
        if (std::memcmp(&expected, &(*found)[i], sizeof expected) == 0) continue;
        spdlog::debug(
            "The GPU's doubles round otherwise than the processor's: runs are composed by the host.");
        return false;
    }
    return true;
}

}  // namespace scancast::gl
