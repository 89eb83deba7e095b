// All memory that is not residency: what is drawn and encoded, what clients have not read yet, texts, connections. It
// is counted as long as it lives, by use, and each use that others could fill has a part of its own that it stays
// within, so that who asks for much takes it from himself.
//
//     a half      frames of stills and snapshots in hand, with what they are encoded into (scheduler/turns.hpp waits)
//     a quarter   pictures and photos that HTTP clients have not read (price/admission.hpp refuses)
//     a quarter   frames that streams have not read (net/: who does not read is closed first), and, of that, up to a half
//                 encoders of sessions' video (scheduler/video_stream.hpp: frames that find no room there are JPEG)
//
// The limit is a fixed share of --memory-limit, taken at the start: what residency has - and ETags name - never varies
// with load.
//
// Owned by the server; holds keep what they need of it. *Thread safety*: any thread. Place: beside everything from
// scheduler to net.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace scancast {

enum class MemoryUse : std::uint8_t {
    Frames,       ///< drawn, and not encoded yet, with the encoder's own
    Answers,      ///< encoded pictures for HTTP clients
    Streams,      ///< encoded frames of streams
    Texts,        ///< requests, JSON and messages that are read or written
    Connections,  ///< their buffers
    Video,        ///< encoders of sessions' moving frames
};
inline constexpr std::size_t memoryUses = 6;
/// "frames"; as /metrics names it.
std::string_view name(MemoryUse use);

class TransientMemory {
    struct State;

  public:
    using Bytes = std::vector<std::uint8_t>;

    /// Bytes that are counted as long as it lives.
    class Hold {
      public:
        Hold() = default;
        Hold(Hold&& other) noexcept
            : state_(std::exchange(other.state_, nullptr)),
              use_(other.use_),
              bytes_(std::exchange(other.bytes_, 0)) {}
        Hold& operator=(Hold&& other) noexcept {
            std::swap(state_, other.state_);
            std::swap(use_, other.use_);
            std::swap(bytes_, other.bytes_);
            return *this;
        }
        ~Hold() { resize(0); }
        void resize(std::uint64_t bytes) noexcept;

      private:
        friend class TransientMemory;
        Hold(std::shared_ptr<State> state, MemoryUse use) : state_(std::move(state)), use_(use) {}

        std::shared_ptr<State> state_;
        MemoryUse use_ = MemoryUse::Texts;
        std::uint64_t bytes_ = 0;
    };

    /// Without a limit: of tests, and where nobody else asks.
    explicit TransientMemory(std::uint64_t limit = std::uint64_t(1) << 62);

    /// Counts them; needs no memory itself.
    Hold hold(MemoryUse use, std::uint64_t bytes = 0) const;
    /// The same bytes, counted for as long as anybody has them; `beside` is kept that long, too.
    std::shared_ptr<const Bytes> shared(MemoryUse use, Bytes bytes,
                                        std::shared_ptr<const void> beside = {}) const;

    std::uint64_t limit() const;
    std::uint64_t forFrames() const { return limit() / 2; }
    std::uint64_t forAnswers() const { return limit() / 4; }
    std::uint64_t forStreams() const { return limit() / 4; }
    std::uint64_t forVideo() const { return forStreams() / 2; }
    std::uint64_t bytes(MemoryUse use) const;
    bool streamsAreFull() const { return bytes(MemoryUse::Streams) + bytes(MemoryUse::Video) > forStreams(); }

  private:
    struct State {
        explicit State(std::uint64_t most) : limit(most) {}
        const std::uint64_t limit;
        std::array<std::atomic<std::uint64_t>, memoryUses> bytes{};
    };
    std::shared_ptr<State> state_;
};

}  // namespace scancast
