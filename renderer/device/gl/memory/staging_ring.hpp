// Memory that the CPU writes and the GPU copies from: mapped once, for good, and used in turn, section by
// section. A section that the GPU may still be copying from is waited for; nothing else is. Owned by the
// sample cache; inside a Current scope of its context.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "renderer/device/gl/programs/gl_handles.hpp"

namespace scancast::gl {

class StagingRing {
  public:
    /// Memory is taken with the first copy.
    StagingRing(const GlFunctions& gl, std::size_t bytes) : gl_(&gl), sectionBytes_(bytes / sections) {}
    ~StagingRing();
    StagingRing(const StagingRing&) = delete;
    StagingRing& operator=(const StagingRing&) = delete;

    /// Copies into the buffer, from `offset` on; `bytes` may go as soon as this returns. Errors:
    /// ResourceLimit, DeviceLost.
    Expected<void> copy(std::span<const std::byte> bytes, const Buffer& target, std::size_t offset);

  private:
    static constexpr std::size_t sections = 4;

    Expected<void> make();
    Expected<void> nextSection();

    const GlFunctions* gl_;
    const std::size_t sectionBytes_;
    GLuint name_ = 0;
    std::byte* mapped_ = nullptr;
    std::size_t section_ = 0, filled_ = 0;   ///< the one being written, and how much of it
    std::array<GLsync, sections> copied_{};  ///< when the GPU was done with the section's last content
};

}  // namespace scancast::gl
