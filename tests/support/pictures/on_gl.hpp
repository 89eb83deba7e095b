// Screen passes on a GL backend without a device around them: a context, kept for the whole test program
// since compiling its shaders takes longer than the tests do, and planes that go there and back.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/device/gl/context/egl_context.hpp"
#include "renderer/device/gl/context/osmesa_context.hpp"
#include "renderer/device/gl/passes/planes.hpp"
#include "renderer/device/gl/programs/screen_shaders.hpp"

namespace scancast::test {

/// A context and what is compiled in it. Members are used, and reset, inside a Current scope.
struct GlBackend {
    std::unique_ptr<gl::Context> context;
    std::optional<gl::Programs> programs;
    std::optional<gl::ScreenShaders> shaders;

    static Expected<GlBackend> open(const std::string& name) {
        auto opened = name == "egl" ? gl::createEglContext() : gl::createOsmesaContext();
        if (!opened) return passOn(opened);
        GlBackend backend;
        backend.context = std::move(*opened);
        return backend;
    }
};

/// Backends are closed before static destructors run: drivers have cleaned up by then.
class SharedBackends : public testing::Environment {
  public:
    void TearDown() override {
        for (auto& [name, backend] : backends_) {
            if (!backend) continue;
            const auto current = gl::Context::Current::enter(*backend->context);
            backend->shaders.reset();
            backend->programs.reset();
        }
        backends_.clear();
    }
    Expected<GlBackend>& get(const std::string& name) {
        const auto found = backends_.find(name);
        return found != backends_.end() ? found->second
                                        : backends_.emplace(name, GlBackend::open(name)).first->second;
    }

  private:
    std::map<std::string, Expected<GlBackend>> backends_;
};
/// Owned by GoogleTest.
inline SharedBackends* const sharedBackends = [] {
    auto* const backends = new SharedBackends;
    testing::AddGlobalTestEnvironment(backends);
    return backends;
}();

/// Parameter: the backend. Its context is current while a test runs.
class OnGl : public testing::TestWithParam<std::string> {
  protected:
    void SetUp() override {
        Expected<GlBackend>& backend = sharedBackends->get(GetParam());
        if (!backend) GTEST_SKIP() << "MISSING BACKEND " << GetParam() << ": " << backend.error().message;
        auto current = gl::Context::Current::enter(*backend->context);
        ASSERT_TRUE(current) << current.error().message;
        current_.emplace(std::move(*current));
        const gl::GlFunctions& functions = backend->context->functions();
        if (!backend->programs) backend->programs.emplace(functions, std::filesystem::path{});
        if (!backend->shaders) backend->shaders.emplace(functions, *backend->programs);
        shaders_ = &*backend->shaders;
    }
    void TearDown() override { current_.reset(); }

    gl::ScreenShaders& shaders() const { return *shaders_; }

  private:
    std::optional<gl::Context::Current> current_;
    gl::ScreenShaders* shaders_ = nullptr;
};

#define INSTANTIATE_ON_GL(FIXTURE)                                \
    INSTANTIATE_TEST_SUITE_P(Gl, FIXTURE, testing::Values("egl"), \
                             [](const testing::TestParamInfo<std::string>& c) { return c.param; })

/// The content of planes, in main memory.
struct PixelPlanes {
    glm::ivec4 area{0};  ///< x, y, width, height
    std::vector<std::uint32_t> rgba;
    std::vector<float> depth;
    std::vector<std::uint32_t> normals;  ///< may be empty

    std::size_t pixels() const { return static_cast<std::size_t>(area.z) * static_cast<std::size_t>(area.w); }
};

/// Buffers behind GpuPlanes, used again from picture to picture.
class PlaneBuffers {
  public:
    explicit PlaneBuffers(const gl::GlFunctions& functions)
        : rgba_(functions, "colours"), depth_(functions, "depths"), normals_(functions, "normals") {}

    gl::GpuPlanes upload(const PixelPlanes& planes) {
        EXPECT_TRUE(rgba_.write(std::as_bytes(std::span(planes.rgba))));
        EXPECT_TRUE(depth_.write(std::as_bytes(std::span(planes.depth))));
        EXPECT_TRUE(normals_.write(std::as_bytes(std::span(planes.normals))));
        gl::GpuPlanes onGpu;
        onGpu.area = planes.area;
        onGpu.rgba = &rgba_;
        onGpu.depth = &depth_;
        if (!planes.normals.empty()) onGpu.normals = &normals_;
        return onGpu;
    }
    void download(PixelPlanes& planes) const {
        rgba_.read(std::as_writable_bytes(std::span(planes.rgba)));
        depth_.read(std::as_writable_bytes(std::span(planes.depth)));
        if (!planes.normals.empty()) normals_.read(std::as_writable_bytes(std::span(planes.normals)));
    }

  private:
    gl::Buffer rgba_, depth_, normals_;
};

/// How many words differ, bit by bit.
template <class T>
std::size_t differences(const std::vector<T>& a, const std::vector<T>& b) {
    static_assert(sizeof(T) == 4);
    if (a.size() != b.size()) return std::max(a.size(), b.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], 4) != 0 ? 1 : 0;
    return count;
}

}  // namespace scancast::test
