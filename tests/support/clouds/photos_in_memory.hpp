// Photos for tests of what is done with them: bytes in memory, which nobody decodes.
#pragma once

#include <functional>
#include <numbers>
#include <utility>

#include "renderer/cloud/cloud.hpp"

namespace scancast::test {

/// What read() answers is the test's; it may also wait there.
class PhotoInMemory final : public PhotoBytes {
  public:
    using Read = std::function<Expected<std::vector<std::byte>>()>;
    explicit PhotoInMemory(Read read) : read_(std::move(read)) {}
    explicit PhotoInMemory(std::vector<std::byte> bytes)
        : read_([bytes = std::move(bytes)]() -> Expected<std::vector<std::byte>> { return bytes; }) {}
    Expected<std::vector<std::byte>> read() const override { return read_(); }

  private:
    const Read read_;
};

/// So many bytes that begin as a file of that format does; `seed` tells them apart.
inline std::vector<std::byte> photoBytes(Photo::Format format, std::size_t count, unsigned char seed = 0) {
    constexpr unsigned char png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'},
                            jpeg[] = {0xff, 0xd8, 0xff, 0xe0};
    std::vector<std::byte> bytes(count, std::byte(seed));
    for (std::size_t i = 0; i < count; ++i) {
        if (format == Photo::Format::Png && i < sizeof png) bytes[i] = std::byte(png[i]);
        if (format == Photo::Format::Jpeg && i < sizeof jpeg) bytes[i] = std::byte(jpeg[i]);
    }
    return bytes;
}

inline Photo photoOf(Photo::Format format, std::vector<std::byte> bytes) {
    Photo photo;
    photo.format = format;
    photo.bytes = bytes.size();
    photo.data = std::make_shared<PhotoInMemory>(std::move(bytes));
    return photo;
}

/// The same cloud with a station and three photos: a panorama taken there, a flat one beside it, and one of which nothing is known.
inline std::shared_ptr<const Cloud> withPhotos(const Cloud& cloud) {
    constexpr double pi = std::numbers::pi;
    auto with = std::make_shared<Cloud>(cloud);
    with->stations = {{.name = "Tower", .position = {5, 5, 2}, .points = 1, .forwards = glm::dvec3(0, 1, 0)}};
    Photo panorama = photoOf(Photo::Format::Jpeg, photoBytes(Photo::Format::Jpeg, 500, 1));
    panorama.name = "All round";
    panorama.projection = Photo::Projection::Spherical;
    panorama.width = 400, panorama.height = 200;
    panorama.pose = Photo::Pose{{5, 5, 2.5}, {0, 1, 0}, {0, 0, 1}};
    panorama.angles = {2 * pi, pi};
    panorama.station = 0;
    Photo flat = photoOf(Photo::Format::Png, photoBytes(Photo::Format::Png, 300, 2));
    flat.projection = Photo::Projection::Pinhole;
    flat.width = 60, flat.height = 80;
    flat.pose = Photo::Pose{{6, 5, 2}, {0.6, 0, -0.8}, {0.8, 0, 0.6}};
    flat.angles = {pi / 3, pi / 2};
    with->photos = {panorama, flat, photoOf(Photo::Format::Jpeg, photoBytes(Photo::Format::Jpeg, 200, 3))};
    return with;
}

}  // namespace scancast::test
