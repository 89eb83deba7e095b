#include "importers/laz/decoder/byte_feed.hpp"

#include <algorithm>

namespace scancast::laz {

void ByteFeed::close() {
    at_ = end_ = nullptr;
    windowEnd_ = limit_ = beyond_ = 0;
    source_ = nullptr;
    open_ = false;
    failure_.reset();
}

void ByteFeed::open(const RandomAccess& source, std::uint64_t from, std::uint64_t to, std::size_t window) {
    close();
    source_ = &source;
    windowEnd_ = from;
    limit_ = to;
    open_ = to > from;
    window_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(window, to - from)));
}

void ByteFeed::open(std::span<const std::byte> bytes, std::uint64_t from) {
    close();
    at_ = bytes.data();
    end_ = at_ + bytes.size();
    windowEnd_ = limit_ = from + bytes.size();
    open_ = !bytes.empty();
}

std::uint8_t ByteFeed::nextBehindWindow() {
    if (source_ && windowEnd_ < limit_ && !failure_) {
        const auto wanted = std::min<std::uint64_t>(window_.size(), limit_ - windowEnd_);
        const auto got =
            source_->readAt(windowEnd_, std::span(window_.data(), static_cast<std::size_t>(wanted)));
        if (!got) {
            failure_ = got.error();
        } else if (*got == 0) {
            failure_ = Error{ErrorCode::Malformed,
                             "byte " + grouped(windowEnd_) + ": the file became shorter while it was read",
                             {}};
        } else {
            at_ = window_.data();
            end_ = at_ + *got;
            windowEnd_ += *got;
            return static_cast<std::uint8_t>(*at_++);
        }
    }
    ++beyond_;
    return 0;
}

void ByteFeed::take(std::span<std::byte> into) {
    for (std::byte& byte : into) byte = static_cast<std::byte>(next());
}

}  // namespace scancast::laz
