#include "importers/laz/decoder/arithmetic_decoder.hpp"

namespace scancast::laz {

void ArithmeticDecoder::close() {
    feed.close();
    value_ = 0;
    length_ = 0xffffffff;
    spoilt_ = false;
}

void ArithmeticDecoder::start() {
    length_ = 0xffffffff;
    value_ = 0;
    spoilt_ = false;
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | feed.next();
    if (value_ == length_) {
        spoil();
        --value_;
    }
}

const char* ArithmeticDecoder::damage(std::uint64_t slack) const {
    if (spoilt_) return "its bytes make no sense";
    return feed.beyond() > slack ? "its points go on beyond its end" : nullptr;
}

}  // namespace scancast::laz
