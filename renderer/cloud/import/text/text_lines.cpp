#include "renderer/cloud/import/text/text_lines.hpp"

#include <algorithm>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

constexpr std::size_t lineBufferBytes = std::size_t(1) << 20;
static_assert(lineBufferBytes > TextLines::peekBytes && TextLines::peekBytes > TextLines::longestLine);

constexpr std::string_view utf8Mark("\xef\xbb\xbf");

bool isUtf16(std::string_view start) {
    return start.starts_with("\xff\xfe") || start.starts_with("\xfe\xff");
}

}  // namespace

TextLines::TextLines(std::unique_ptr<ByteSource> bytes, std::string name)
    : bytes_(std::move(bytes)), name_(std::move(name)), buffer_(lineBufferBytes) {}

Expected<void> TextLines::open() {
    while (filled_ < peekBytes && !ended_)
        if (auto ok = refill(); !ok) return ok;
    const std::string_view text(buffer_.data(), filled_);
    if (isUtf16(text))
        return fail(ErrorCode::Unsupported, name_ + ": the text is UTF-16; save it as UTF-8 or ASCII");
    if (text.starts_with(utf8Mark)) at_ = taken_ = utf8Mark.size();
    if (text.find('\n') == text.npos && text.find('\r') != text.npos) lineEnd_ = '\r';
    if (start().empty() && !ended_)
        return fail(ErrorCode::Malformed,
                    name_ + ", line 1: the line is longer than " + grouped(longestLine) + " bytes");
    return {};
}

std::string_view TextLines::start() const {
    const std::string_view text(buffer_.data() + at_, filled_ - at_);
    if (ended_ && text.size() <= peekBytes) return text;
    const auto last = text.substr(0, peekBytes).rfind(lineEnd_);
    return last == text.npos ? std::string_view() : text.substr(0, last + 1);
}

Expected<std::vector<std::string>> TextLines::samples(std::size_t places, std::size_t bytes) {
    std::vector<std::string> result;
    const auto size = bytes_->size();
    if (!size || *size <= peekBytes) return result;
    std::string piece;
    for (std::size_t i = 1; i <= places; ++i) {
        piece.resize(bytes);
        const auto from = *size / (places + 1) * i;
        const auto got = bytes_->readAt(from, std::as_writable_bytes(std::span(piece)));
        if (!got) return passOn(got);
        piece.resize(*got);
        // What stands before the first and behind the last end of a line are parts of lines.
        auto begin = piece.find(lineEnd_);
        while (begin != piece.npos) {
            const auto end = piece.find(lineEnd_, ++begin);
            if (end == piece.npos) break;
            result.push_back(piece.substr(begin, end - begin));
            if (result.back().ends_with('\r')) result.back().pop_back();
            begin = end;
        }
    }
    return result;
}

Expected<bool> TextLines::nextAcrossBuffers(std::string_view& line) {
    for (;;) {
        const auto* from = buffer_.data() + at_;
        const auto* end = static_cast<const char*>(std::memchr(from, lineEnd_, filled_ - at_));
        const auto there = end == nullptr ? filled_ - at_ : static_cast<std::size_t>(end - from);
        if (there > longestLine) {
            ++lineNumber_;
            return fail(ErrorCode::Malformed,
                        place() + "the line is longer than " + grouped(longestLine) + " bytes");
        }
        if (end != nullptr) {
            take(from, there, 1, line);
            return true;
        }
        if (ended_) {
            if (there == 0) return false;
            take(from, there, 0, line);
            return true;
        }
        if (auto ok = refill(); !ok) return passOn(ok);
    }
}

/// Moves what is not taken yet to the front and reads behind it once.
Expected<void> TextLines::refill() {
    if (at_ > 0) {
        std::memmove(buffer_.data(), buffer_.data() + at_, filled_ - at_);
        filled_ -= at_;
        at_ = 0;
    }
    const auto room = std::span(buffer_).subspan(filled_);
    const auto got = bytes_->read(std::as_writable_bytes(room));
    if (!got) return passOn(got);
    ended_ = *got == 0;
    filled_ += *got;
    return {};
}

std::string TextLines::place() const {
    return name_ + ", line " + grouped(lineNumber_) + ": ";
}

}  // namespace scancast
