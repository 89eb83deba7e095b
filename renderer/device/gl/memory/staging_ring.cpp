#include "renderer/device/gl/memory/staging_ring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace scancast::gl {

StagingRing::~StagingRing() {
    for (const GLsync fence : copied_)
        if (fence) gl_->DeleteSync(fence);
    if (name_) gl_->DeleteBuffers(1, &name_);  // which unmaps it, too
}

Expected<void> StagingRing::make() {
    const auto bytes = static_cast<GLsizeiptr>(sections * sectionBytes_);
    constexpr GLbitfield access = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    gl_->CreateBuffers(1, &name_);
    gl_->NamedBufferStorage(name_, bytes, nullptr, access | GL_CLIENT_STORAGE_BIT);
    void* const mapped = gl_->MapNamedBufferRange(name_, 0, bytes, access);
    if (mapped) {
        mapped_ = static_cast<std::byte*>(mapped);
        return {};
    }
    gl_->DeleteBuffers(1, &name_);
    name_ = 0;
    auto checked = checkErrors(*gl_, fmt::format("mapping memory for uploads ({} bytes)", bytes));
    if (!checked) return checked;
    return fail(ErrorCode::ResourceLimit, "glMapNamedBufferRange gave no memory for uploads.");
}

Expected<void> StagingRing::nextSection() {
    copied_[section_] = gl_->FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    section_ = (section_ + 1) % sections;
    filled_ = 0;
    const GLsync before = std::exchange(copied_[section_], nullptr);
    return before ? finishFence(*gl_, before, "waiting for uploads") : Expected<void>{};
}

Expected<void> StagingRing::copy(std::span<const std::byte> bytes, const Buffer& target, std::size_t offset) {
    if (!mapped_) {
        if (auto ok = make(); !ok) return ok;
    }
    while (!bytes.empty()) {
        if (filled_ == sectionBytes_) {
            if (auto ok = nextSection(); !ok) return ok;
        }
        const std::size_t count = std::min(bytes.size(), sectionBytes_ - filled_);
        const std::size_t from = section_ * sectionBytes_ + filled_;
        std::memcpy(mapped_ + from, bytes.data(), count);
        gl_->CopyNamedBufferSubData(name_, target.name(), static_cast<GLintptr>(from),
                                    static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(count));
        filled_ += count;
        offset += count;
        bytes = bytes.subspan(count);
    }
    return {};
}

}  // namespace scancast::gl
