// Pictures on their way from the GPU: copied into mapped memory behind a fence, so that the next one can be
// begun before this one is here, and lent to whoever encodes them, so that nobody copies them again. Owned by
// a GL device; everything inside a Current scope of its context, except that a Transfer may be dropped
// without one. Pipeline: planes → **read-back** → frame.
//
// What is lent is given back on any thread, without a call of OpenGL: a flag says so, and the device's thread
// uses the memory for another picture. It may outlive the device: what is lent then is left to the context,
// which every loan keeps, and which goes with the last of them - on that loan's thread, where no context may
// be current. A context that is lost takes nothing away either: only what arrived before is lent (wait()
// looks for a reset last), and mapped memory stays until the context is destroyed. OpenGL does not say what a
// reset does to it; it is the process's own memory, if drivers do as GL_CLIENT_STORAGE asks.
//
// There are as many buffers as pictures alive at once, so whoever keeps frames bounds them: the scheduler
// does. A buffer is not used for a picture that needs less than a quarter of it, unless it is small, and goes
// when it was not used for a while: a poster's memory does not stay because screens are drawn.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "renderer/device/gl/programs/gl_handles.hpp"
#include "renderer/image/pixels.hpp"

namespace scancast::gl {

class ReadBack {
    struct Slot;
    struct Loan;

  public:
    /// Pictures for which a free buffer waits before it goes.
    static constexpr std::uint64_t longestIdle = 64;
    /// Up to so many bytes any buffer that is large enough is used.
    static constexpr std::size_t smallSlot = std::size_t{1} << 20;

    /// `context`: what the mapped memory needs beside the ReadBack; each loan keeps it.
    ReadBack(const GlFunctions& gl, std::shared_ptr<const void> context)
        : gl_(gl), context_(std::move(context)) {}
    ~ReadBack();
    ReadBack(const ReadBack&) = delete;
    ReadBack& operator=(const ReadBack&) = delete;

    /// One picture's pixels on their way. Not later than the ReadBack.
    class Transfer {
      public:
        Transfer(const Transfer&) = delete;
        Transfer& operator=(const Transfer&) = delete;

        /// Whether wait() would return at once.
        bool ready();
        /// Until they are here. Errors: Cancelled, DeviceLost.
        Expected<void> wait(const std::stop_token& stop);
        /// After wait(): lent, from where they arrived.
        Pixels<std::uint8_t> rgba() const;
        /// Empty where none was read back.
        Pixels<float> depth() const;

      private:
        friend class ReadBack;
        Transfer(const GlFunctions& gl, std::shared_ptr<const Loan> loan, std::size_t pixels, bool depth)
            : gl_(gl), loan_(std::move(loan)), pixels_(pixels), depth_(depth) {}
        const GlFunctions& gl_;
        const std::shared_ptr<const Loan> loan_;
        const std::size_t pixels_;
        const bool depth_;
    };

    /// Starts with the first `pixels` words of the colours, and of the depths unless nullptr. ResourceLimit:
    /// no memory.
    Expected<std::unique_ptr<Transfer>> start(const Buffer& rgba, const Buffer* depth, std::size_t pixels);

    /// Bytes of all its buffers, lent or free.
    std::size_t bytes() const;

  private:
    struct Slot {
        explicit Slot(std::shared_ptr<const void> keeps) : context(std::move(keeps)) {}
        std::atomic<bool> lent = false;  ///< cleared by whoever drops the loan, on whatever thread
        GLuint buffer = 0;
        const std::byte* mapped = nullptr;
        std::size_t bytes = 0;
        GLsync fence = nullptr;
        std::uint64_t lastUsed = 0;
        const std::shared_ptr<const void> context;
    };
    /// What a picture's frames share until the last of them goes.
    struct Loan {
        explicit Loan(std::shared_ptr<Slot> from) : slot(std::move(from)) {
            slot->lent.store(true, std::memory_order_relaxed);
        }
        Loan(const Loan&) = delete;
        Loan& operator=(const Loan&) = delete;
        /// All that was read is read before somebody sees the flag and has the GPU write there.
        ~Loan() { slot->lent.store(false, std::memory_order_release); }
        const std::shared_ptr<Slot> slot;
    };

    /// A free slot of at least so many bytes, mapped.
    Expected<std::shared_ptr<Slot>> slotOf(std::size_t bytes);
    Expected<void> makeRoom(Slot& slot, std::size_t bytes);
    void release(Slot& slot);
    void dropIdle();

    const GlFunctions& gl_;
    const std::shared_ptr<const void> context_;
    std::vector<std::shared_ptr<Slot>> slots_;
    std::uint64_t started_ = 0;  ///< pictures
};

}  // namespace scancast::gl
