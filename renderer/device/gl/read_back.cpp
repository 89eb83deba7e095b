#include "renderer/device/gl/read_back.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace scancast::gl {
namespace {

/// Between two looks at the stop token.
constexpr GLuint64 waitStepNs = 5'000'000;
constexpr int longestWaitSteps = 2000;

}  // namespace

ReadBack::~ReadBack() {
    for (Slot& slot : slots_) release(slot);
}

void ReadBack::release(Slot& slot) {
    if (slot.fence) gl_.DeleteSync(slot.fence);
    if (slot.buffer) gl_.DeleteBuffers(1, &slot.buffer);  // which unmaps it, too
    slot = {};
}

Expected<void> ReadBack::reserve(Slot& slot, std::size_t bytes) {
    if (slot.fence) gl_.DeleteSync(std::exchange(slot.fence, nullptr));
    if (slot.bytes >= bytes) return {};
    release(slot);
    constexpr GLbitfield access = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    gl_.CreateBuffers(1, &slot.buffer);
    gl_.NamedBufferStorage(slot.buffer, static_cast<GLsizeiptr>(bytes), nullptr,
                           access | GL_CLIENT_STORAGE_BIT);
    slot.mapped = static_cast<const std::byte*>(
        gl_.MapNamedBufferRange(slot.buffer, 0, static_cast<GLsizeiptr>(bytes), access));
    if (slot.mapped) {
        slot.bytes = bytes;
        return {};
    }
    release(slot);
    auto checked = checkErrors(gl_, "mapping memory for pictures (" + std::to_string(bytes) + " bytes)");
    if (!checked) return checked;
    return fail(ErrorCode::ResourceLimit, "glMapNamedBufferRange gave no memory for pictures.");
}

Expected<std::unique_ptr<ReadBack::Pixels>> ReadBack::start(const Buffer& rgba, const Buffer& depth,
                                                            std::size_t pixels) {
    auto slot = std::ranges::find(slots_, false, &Slot::taken);
    if (slot == slots_.end()) slot = slots_.insert(slot, Slot{});
    const std::size_t bytes = pixels * 4;
    if (auto made = reserve(*slot, 2 * bytes); !made) return tl::unexpected(made.error());
    const auto copy = [&](const Buffer& from, std::size_t to) {
        gl_.CopyNamedBufferSubData(from.name(), slot->buffer, 0, static_cast<GLintptr>(to),
                                   static_cast<GLsizeiptr>(bytes));
    };
    gl_.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    copy(rgba, 0);
    copy(depth, bytes);
    gl_.MemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    slot->fence = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (auto checked = checkErrors(gl_, "reading the picture back"); !checked)
        return tl::unexpected(checked.error());
    slot->taken = true;
    return std::unique_ptr<Pixels>(
        new Pixels(*this, static_cast<std::size_t>(slot - slots_.begin()), pixels));
}

ReadBack::Pixels::~Pixels() {
    owner_.slots_[slot_].taken = false;
}

bool ReadBack::Pixels::ready() {
    const GlFunctions& gl = owner_.gl_;
    const GLenum result = gl.ClientWaitSync(owner_.slots_[slot_].fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
    return result != GL_TIMEOUT_EXPIRED;  // wait() tells what went wrong
}

Expected<void> ReadBack::Pixels::wait(const std::stop_token& stop) {
    const GlFunctions& gl = owner_.gl_;
    for (int i = 0; i < longestWaitSteps; ++i) {
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        const GLenum result =
            gl.ClientWaitSync(owner_.slots_[slot_].fence, GL_SYNC_FLUSH_COMMANDS_BIT, waitStepNs);
        if (result == GL_TIMEOUT_EXPIRED) continue;
        if (auto checked = checkErrors(gl, "waiting for the picture"); !checked) return checked;
        if (result != GL_WAIT_FAILED) return {};
        break;
    }
    return fail(ErrorCode::DeviceLost,
                "glClientWaitSync: the GPU did not finish a picture within ten seconds.");
}

std::span<const std::uint8_t> ReadBack::Pixels::rgba() const {
    return {reinterpret_cast<const std::uint8_t*>(owner_.slots_[slot_].mapped), pixels_ * 4};
}

std::span<const float> ReadBack::Pixels::depth() const {
    return {reinterpret_cast<const float*>(owner_.slots_[slot_].mapped + pixels_ * 4), pixels_};
}

}  // namespace scancast::gl
