#include "server/base/transient_memory.hpp"

namespace scancast {

std::string_view name(MemoryUse use) {
    switch (use) {
        case MemoryUse::Frames:
            return "frames";
        case MemoryUse::Answers:
            return "answers";
        case MemoryUse::Streams:
            return "streams";
        case MemoryUse::Texts:
            return "texts";
        case MemoryUse::Connections:
            return "connections";
        case MemoryUse::Video:
            return "video";
    }
    return "unknown";
}

TransientMemory::TransientMemory(std::uint64_t limit) : state_(std::make_shared<State>(limit)) {}

void TransientMemory::Hold::resize(std::uint64_t bytes) noexcept {
    if (!state_) return;
    auto& all = state_->bytes[std::size_t(use_)];
    all += bytes;
    all -= std::exchange(bytes_, bytes);
}

TransientMemory::Hold TransientMemory::hold(MemoryUse use, std::uint64_t bytes) const {
    Hold hold(state_, use);
    hold.resize(bytes);
    return hold;
}

std::shared_ptr<const TransientMemory::Bytes> TransientMemory::shared(
    MemoryUse use, Bytes bytes, std::shared_ptr<const void> beside) const {
    struct Counted {
        Bytes bytes;
        std::shared_ptr<const void> beside;
        Hold hold;
    };
    auto counted = std::make_shared<Counted>(Counted{std::move(bytes), std::move(beside), hold(use)});
    counted->hold.resize(counted->bytes.capacity());
    return {counted, &counted->bytes};
}

std::uint64_t TransientMemory::limit() const {
    return state_->limit;
}

std::uint64_t TransientMemory::bytes(MemoryUse use) const {
    return state_->bytes[std::size_t(use)];
}

}  // namespace scancast
