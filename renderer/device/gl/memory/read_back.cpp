#include "renderer/device/gl/memory/read_back.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scancast::gl {
namespace {

/// Between two looks at the stop token.
constexpr GLuint64 waitStepNs = 5'000'000;
constexpr int longestWaitSteps = 2000;

bool isFree(const std::atomic<bool>& lent) {
    return !lent.load(std::memory_order_acquire);
}

}  // namespace

ReadBack::~ReadBack() {
    for (const auto& slot : slots_) {
        if (isFree(slot->lent))
            release(*slot);
        else if (slot->fence)
            gl_.DeleteSync(slot->fence);  // the buffer goes with the context, which the loan keeps
    }
}

void ReadBack::release(Slot& slot) {
    if (slot.fence) gl_.DeleteSync(std::exchange(slot.fence, nullptr));
    if (slot.buffer) gl_.DeleteBuffers(1, &slot.buffer);  // which unmaps it, too
    slot.buffer = 0;
    slot.mapped = nullptr;
    slot.bytes = 0;
}

std::size_t ReadBack::bytes() const {
    std::size_t all = 0;
    for (const auto& slot : slots_) all += slot->bytes;
    return all;
}

void ReadBack::dropIdle() {
    std::erase_if(slots_, [&](const std::shared_ptr<Slot>& slot) {
        const bool idle = slot->lastUsed + longestIdle < started_ && isFree(slot->lent);
        if (idle) release(*slot);
        return idle;
    });
}

Expected<void> ReadBack::makeRoom(Slot& slot, std::size_t bytes) {
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
    auto checked = checkErrors(gl_, fmt::format("mapping memory for pictures ({} bytes)", bytes));
    if (!checked) return checked;
    return fail(ErrorCode::ResourceLimit, "glMapNamedBufferRange gave no memory for pictures.");
}

Expected<std::shared_ptr<ReadBack::Slot>> ReadBack::slotOf(std::size_t bytes) {
    ++started_;
    dropIdle();
    const std::size_t largest = std::max(bytes * 4, smallSlot);
    std::shared_ptr<Slot> best, tooSmall;
    for (const auto& slot : slots_) {
        if (!isFree(slot->lent) || slot->bytes > largest) continue;
        if (slot->bytes < bytes)
            tooSmall = slot;
        else if (!best || slot->bytes < best->bytes)
            best = slot;
    }
    if (!best) best = tooSmall;  // it grows, rather than that there is one more
    if (!best) best = slots_.emplace_back(std::make_shared<Slot>(context_));
    best->lastUsed = started_;
    if (auto ok = makeRoom(*best, bytes); !ok) return passOn(ok);
    return best;
}

Expected<std::unique_ptr<ReadBack::Transfer>> ReadBack::start(const Buffer& rgba, const Buffer* depth,
                                                              std::size_t pixels) {
    const std::size_t bytes = pixels * 4;
    auto slot = slotOf(depth ? 2 * bytes : bytes);
    if (!slot) return passOn(slot);
    const auto copy = [&](const Buffer& from, std::size_t to) {
        gl_.CopyNamedBufferSubData(from.name(), (*slot)->buffer, 0, static_cast<GLintptr>(to),
                                   static_cast<GLsizeiptr>(bytes));
    };
    gl_.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    copy(rgba, 0);
    if (depth) copy(*depth, bytes);
    gl_.MemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    (*slot)->fence = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (auto ok = checkErrors(gl_, "reading the picture back"); !ok) return passOn(ok);
    return std::unique_ptr<Transfer>(
        new Transfer(gl_, std::make_shared<const Loan>(std::move(*slot)), pixels, depth != nullptr));
}

bool ReadBack::Transfer::ready() {
    const GLenum result = gl_.ClientWaitSync(loan_->slot->fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
    return result != GL_TIMEOUT_EXPIRED;  // wait() tells what went wrong
}

Expected<void> ReadBack::Transfer::wait(const std::stop_token& stop) {
    for (int i = 0; i < longestWaitSteps; ++i) {
        if (stop.stop_requested())
            return fail(ErrorCode::Cancelled, "The picture was abandoned: it is no longer wanted.");
        const GLenum result = gl_.ClientWaitSync(loan_->slot->fence, GL_SYNC_FLUSH_COMMANDS_BIT, waitStepNs);
        if (result == GL_TIMEOUT_EXPIRED) continue;
        if (auto ok = checkErrors(gl_, "waiting for the picture"); !ok) return ok;
        if (result != GL_WAIT_FAILED) return {};
        break;
    }
    return fail(ErrorCode::DeviceLost,
                "glClientWaitSync: the GPU did not finish a picture within ten seconds.");
}

Pixels<std::uint8_t> ReadBack::Transfer::rgba() const {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(loan_->slot->mapped);
    return Pixels<std::uint8_t>::lent({first, pixels_ * 4}, loan_);
}

Pixels<float> ReadBack::Transfer::depth() const {
    if (!depth_) return {};
    const auto* const first = reinterpret_cast<const float*>(loan_->slot->mapped + pixels_ * 4);
    return Pixels<float>::lent({first, pixels_}, loan_);
}

}  // namespace scancast::gl
