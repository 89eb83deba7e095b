// A point stream's photos: PointStreamReader's part that reads them.
#include <algorithm>
#include <array>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"

namespace scancast {

namespace stream = point_stream;

Expected<void> PointStreamReader::readPhoto() {
    if (head_.n == 0 || head_.n > stream::longestPhoto)
        return wrong("a photo whose description has " + grouped(head_.n) + " bytes");
    if (photos_.size() == mostPhotos) return wrong("more than " + grouped(mostPhotos) + " photos");
    std::string text(head_.n, '\0');
    if (auto ok = readExactly(std::as_writable_bytes(std::span(text))); !ok) return ok;
    auto photo = stream::decodePhoto(text);
    if (!photo) return passOn(photo);
    if (photo->station && *photo->station >= stations_.size())
        return wrong("a photo from station " + grouped(*photo->station) + ", of " +
                     grouped(stations_.size()));
    if (photo->bytes > options_.mostPhotoBytes - photoBytes_)
        return wrong("photos of more bytes than its file has");
    photoBytes_ += photo->bytes;
    photos_.push_back(std::move(*photo));
    photosCame_.push_back(false);
    return {};
}

Expected<void> PointStreamReader::readPhotoBytes() {
    const auto index = head_.n;
    if (index >= photos_.size())
        return wrong("the bytes of photo " + grouped(index) + ", of " + grouped(photos_.size()));
    if (photosCame_[index]) return wrong("the bytes of photo " + grouped(index) + " for the second time");
    photosCame_[index] = true;
    Photo& photo = photos_[index];
    constexpr std::uint64_t pieceBytes = std::uint64_t(256) << 10;
    std::vector<std::byte> piece(std::min(photo.bytes, pieceBytes));
    spool_.begin(photo.bytes);
    for (std::uint64_t left = photo.bytes; left > 0; left -= piece.size()) {
        piece.resize(std::min(left, pieceBytes));
        if (auto ok = readExactly(piece); !ok) return ok;
        if (left == photo.bytes && photoFormat(piece) != photo.format)
            return wrong("photo " + grouped(index) + " is no " + std::string(name(photo.format)));
        spool_.take(piece);
    }
    photo.data = spool_.end();
    return {};
}

void PointStreamReader::noteLostPhotos(std::vector<std::string>& notes) const {
    const auto note = [&](std::uint64_t count, const char* reason) {
        if (count == 0) return;
        notes.push_back(grouped(count) + (count == 1 ? " photo" : " photos") + " left out: " + reason);
    };
    note(spool_.lost(), spool_.reason());
    if (done_) note(std::uint64_t(std::ranges::count(photosCame_, false)), "unreadable");
}

}  // namespace scancast
