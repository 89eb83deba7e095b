#include "renderer/device/gl/gl_passes.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace scancast::gl {
namespace {

constexpr std::uint32_t infiniteOrder = 0x7f800000;
constexpr std::uint32_t noPayload = 0xffffffff;
/// Sample pages on the GPU at once (1 GiB); cuts beyond that travel once more per stage.
constexpr std::size_t mostSlots = 16;
constexpr std::size_t noPage = SIZE_MAX;
/// OpenGL promises 65,535 work groups.
constexpr std::uint32_t largestSlice = 32768;
constexpr double shortSliceMs = 2, longSliceMs = 6;

template <class T>
std::span<const std::byte> bytesOf(const std::vector<T>& values) {
    return std::as_bytes(std::span(values));
}

template <class T>
std::span<const std::byte> bytesOf(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

}  // namespace

Passes::Passes(const GlFunctions& gl, const std::filesystem::path& programFolder)
    : gl_(gl),
      programs_(gl, programFolder),
      params_(gl, "pass parameters"),
      runs_(gl, "runs"),
      chunks_(gl, "chunks"),
      colors_(gl, "colour tables"),
      background_(gl, "background"),
      orders_(gl, "orders"),
      payloads_(gl, "payloads"),
      resolved_(gl, "resolved picture"),
      shaded_(gl, "shaded picture") {
    GLint64 block = 0;
    gl_.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block);
    if (block > 0) limits_.storageBlockBytes = static_cast<std::size_t>(block);
}

std::size_t Passes::areaPixels() const {
    return static_cast<std::size_t>(plan_->pass.area.z) * static_cast<std::size_t>(plan_->pass.area.w);
}

Expected<void> Passes::begin(const DrawPlan& plan) {
    plan_ = &plan;
    for (Slot& slot : slots_) slot.page = noPage;
    while (slots_.size() < std::min(plan.pages.size(), mostSlots))
        slots_.push_back({Buffer(gl_, "sample page", Buffer::Use::Uploads), noPage});

    const std::size_t pixelBytes = areaPixels() * 4;
    for (const auto& done : {runs_.write(bytesOf(plan.runs)), chunks_.write(bytesOf(plan.chunks)),
                             colors_.write(bytesOf(plan.colors)), background_.write(bytesOf(plan.background)),
                             orders_.reserve(pixelBytes), payloads_.reserve(pixelBytes),
                             resolved_.reserve(pixelBytes), shaded_.reserve(plan.eyeDome ? pixelBytes : 0)}) {
        if (!done) return done;
    }
    runs_.bindStorage(BindRuns);
    chunks_.bindStorage(BindChunks);
    colors_.bindStorage(BindColors);
    background_.bindStorage(BindBackground);
    orders_.bindStorage(BindOrders);
    payloads_.bindStorage(BindPayloads);
    resolved_.bindStorage(BindResolved);
    shaded_.bindStorage(BindShaded);
    return {};
}

Expected<void> Passes::bindPage(std::size_t page) {
    Slot& slot = slots_[page % slots_.size()];
    if (slot.page != page) {
        const SamplePage& content = plan_->pages[page];
        auto filled = slot.buffer.fill(content.samples * sizeof(Sample), [&](std::span<std::byte> out) {
            for (const auto& segment : content.segments) {
                std::memcpy(out.data(), segment.data(), segment.size_bytes());
                out = out.subspan(segment.size_bytes());
            }
        });
        if (!filled) return filled;
        slot.page = page;
    }
    slot.buffer.bindStorage(BindSamples);
    return {};
}

Expected<void> Passes::splatPage(const SamplePage& page, const std::stop_token& stop) {
    for (std::uint32_t first = 0; first < page.chunks;) {
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        const auto start = std::chrono::steady_clock::now();
        const std::uint32_t count = std::min(sliceChunks_, page.chunks - first);
        gl_.Uniform1ui(0, page.firstChunk + first);
        gl_.DispatchCompute(count, 1, 1);
        if (auto done = waitForGpu(gl_); !done) return done;
        const double ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        if (ms < shortSliceMs && count == sliceChunks_)
            sliceChunks_ = std::min(sliceChunks_ * 2, largestSlice);
        if (ms > longSliceMs) sliceChunks_ = std::max(sliceChunks_ / 2, 1u);
        first += count;
    }
    return {};
}

Expected<void> Passes::splat(int stage, const std::stop_token& stop) {
    const auto nearestProgram = programs_.get("nearest.comp", plan_->variant.defines(stage));
    if (!nearestProgram) return tl::unexpected(nearestProgram.error());
    (*nearestProgram)->use();
    for (std::size_t i = 0; i < plan_->pages.size(); ++i) {
        if (auto bound = bindPage(i); !bound) return bound;
        if (auto drawn = splatPage(plan_->pages[i], stop); !drawn) return drawn;
    }
    gl_.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    return {};
}

Expected<void> Passes::nearest(const glm::dvec2& jitter, const std::stop_token& stop) {
    PassParams pass = plan_->pass;
    // Added in double, as everything that places samples is.
    pass.view.x = static_cast<float>(plan_->center.x + jitter.x);
    pass.view.y = static_cast<float>(plan_->center.y + jitter.y);
    if (auto written = params_.write(bytesOf(pass)); !written) return written;
    params_.bindUniform(BindParams);
    orders_.clear(areaPixels(), infiniteOrder);
    payloads_.clear(areaPixels(), noPayload);
    gl_.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    for (const int stage : {0, 1}) {
        if (auto drawn = splat(stage, stop); !drawn) return drawn;
    }
    return checkErrors(gl_, "running the nearest pass");
}

void Passes::dispatchScreen(int width, int height) {
    gl_.DispatchCompute(static_cast<GLuint>(width + 15) / 16, static_cast<GLuint>(height + 7) / 8, 1);
    gl_.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

Expected<void> Passes::resolve() {
    const auto resolveProgram = programs_.get("resolve.comp", {});
    if (!resolveProgram) return tl::unexpected(resolveProgram.error());
    (*resolveProgram)->use();
    dispatchScreen(plan_->pass.area.z, plan_->pass.area.w);
    if (auto done = waitForGpu(gl_); !done) return done;
    return checkErrors(gl_, "running the resolve pass");
}

Expected<void> Passes::eyeDome() {
    const auto eyeDomeProgram = programs_.get("eye_dome.comp", {});
    if (!eyeDomeProgram) return tl::unexpected(eyeDomeProgram.error());
    (*eyeDomeProgram)->use();
    if (auto written = params_.write(bytesOf(*plan_->eyeDome)); !written) return written;
    params_.bindUniform(BindParams);
    dispatchScreen(plan_->window.z, plan_->window.w);
    if (auto done = waitForGpu(gl_); !done) return done;
    return checkErrors(gl_, "running the eye-dome pass");
}

Expected<void> Passes::readColor(std::span<std::uint8_t> rgba) {
    // Without eye-dome lighting the area is the window.
    (plan_->eyeDome ? shaded_ : resolved_).read(std::as_writable_bytes(rgba));
    return checkErrors(gl_, "reading the picture back");
}

Expected<void> Passes::readDepth(std::span<float> depth) {
    const ivec4 area = plan_->pass.area, window = plan_->window;
    if (area == window) {
        orders_.read(std::as_writable_bytes(depth));
    } else {
        areaDepth_.resize(areaPixels());
        orders_.read(std::as_writable_bytes(std::span(areaDepth_)));
        for (int y = 0; y < window.w; ++y) {
            const auto row =
                static_cast<std::ptrdiff_t>(window.y - area.y + y) * area.z + (window.x - area.x);
            std::copy_n(areaDepth_.begin() + row, window.z,
                        depth.begin() + static_cast<std::ptrdiff_t>(y) * window.z);
        }
    }
    return checkErrors(gl_, "reading the depths back");
}

}  // namespace scancast::gl
