// A GL context of a test's own, and what a driver is asked for. (Contexts that a whole test program shares:
// on_gl.hpp.)
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/device/gl/context/egl_context.hpp"
#include "renderer/device/gl/context/osmesa_context.hpp"

namespace scancast::gl {

/// Parameter: the backend. A fresh context, current while a test runs; null where the test is skipped.
class WithContext : public testing::TestWithParam<std::string> {
  protected:
    static Expected<std::unique_ptr<Context>> open() {
        return GetParam() == "egl" ? createEglContext() : createOsmesaContext();
    }
    void SetUp() override {
        auto opened = open();
        if (!opened) GTEST_SKIP() << "MISSING BACKEND " << GetParam() << ": " << opened.error().message;
        auto current = Context::Current::enter(**opened);
        ASSERT_TRUE(current) << current.error().message;
        context_ = std::move(*opened);
        current_.emplace(std::move(*current));
    }
    void TearDown() override { current_.reset(); }

    const GlFunctions& gl() const { return context_->functions(); }

    std::shared_ptr<Context> context_;
    std::optional<Context::Current> current_;
};

struct GlCalls {
    int created = 0, deleted = 0;
    GLsizeiptr copied = 0;
    std::vector<void*> mapped;
};

/// What the driver was asked for, in front of a context's own functions; one at a time.
class NotedGl {
  public:
    explicit NotedGl(const GlFunctions& own) : functions(own) {
        noted = {};
        real = own;
        functions.CreateBuffers = [](GLsizei count, GLuint* names) {
            noted.created += count;
            real.CreateBuffers(count, names);
        };
        functions.DeleteBuffers = [](GLsizei count, const GLuint* names) {
            noted.deleted += count;
            real.DeleteBuffers(count, names);
        };
        functions.MapNamedBufferRange = [](GLuint buffer, GLintptr from, GLsizeiptr bytes,
                                           GLbitfield access) {
            noted.mapped.push_back(real.MapNamedBufferRange(buffer, from, bytes, access));
            return noted.mapped.back();
        };
        functions.CopyNamedBufferSubData = [](GLuint a, GLuint b, GLintptr from, GLintptr to,
                                              GLsizeiptr bytes) {
            noted.copied += bytes;
            real.CopyNamedBufferSubData(a, b, from, to, bytes);
        };
    }
    static inline GlCalls noted;
    GlFunctions functions;

  private:
    static inline GlFunctions real;
};

}  // namespace scancast::gl
