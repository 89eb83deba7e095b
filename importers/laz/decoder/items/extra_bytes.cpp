#include "importers/laz/decoder/items/extra_bytes.hpp"

#include <cstring>

namespace scancast::laz {

void ExtraBytesV1::start(const std::byte* item) {
    std::memcpy(last_.data(), item, last_.size());
    values_.reset();
}

void ExtraBytesV1::decode(std::byte* item) {
    for (std::size_t i = 0; i < last_.size(); ++i)
        last_[i] = static_cast<std::byte>(values_.decode(decoder_, static_cast<int>(last_[i]), i));
    std::memcpy(item, last_.data(), last_.size());
}

void ExtraBytesV2::start(const std::byte* item) {
    std::memcpy(last_.data(), item, last_.size());
    for (auto& model : differences_) model.reset();
}

void ExtraBytesV2::decode(std::byte* item) {
    for (std::size_t i = 0; i < last_.size(); ++i)
        last_[i] =
            static_cast<std::byte>(static_cast<std::uint32_t>(last_[i]) + decoder_.symbol(differences_[i]));
    std::memcpy(item, last_.data(), last_.size());
}

}  // namespace scancast::laz
