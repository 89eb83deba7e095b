#include "renderer/cloud/stations/photo.hpp"

#include <cstring>
#include <span>
#include <utility>

namespace scancast {

namespace {

constexpr std::pair<Photo::Format, std::string_view> photoFormats[] = {
    {Photo::Format::Jpeg, "jpeg"},
    {Photo::Format::Png, "png"},
};
constexpr std::pair<Photo::Projection, std::string_view> photoProjections[] = {
    {Photo::Projection::Visual, "visual"},
    {Photo::Projection::Pinhole, "pinhole"},
    {Photo::Projection::Spherical, "spherical"},
    {Photo::Projection::Cylindrical, "cylindrical"},
};

template <class T, std::size_t n>
std::optional<T> valueOf(const std::pair<T, std::string_view> (&names)[n], std::string_view wanted) {
    for (const auto& [value, name] : names)
        if (name == wanted) return value;
    return std::nullopt;
}

}  // namespace

std::string_view name(Photo::Format format) {
    return photoFormats[std::size_t(format)].second;
}

std::optional<Photo::Format> photoFormatOf(std::string_view name) {
    return valueOf(photoFormats, name);
}

std::string_view mediaType(Photo::Format format) {
    return format == Photo::Format::Jpeg ? "image/jpeg" : "image/png";
}

std::string_view name(Photo::Projection projection) {
    return photoProjections[std::size_t(projection)].second;
}

std::optional<Photo::Projection> photoProjectionOf(std::string_view name) {
    return valueOf(photoProjections, name);
}

std::optional<Photo::Format> photoFormat(std::span<const std::byte> start) {
    constexpr std::string_view jpeg = "\xff\xd8\xff", png = "\x89PNG\r\n\x1a\n";
    const auto begins = [&](std::string_view with) {
        return start.size() >= with.size() && std::memcmp(start.data(), with.data(), with.size()) == 0;
    };
    if (begins(jpeg)) return Photo::Format::Jpeg;
    if (begins(png)) return Photo::Format::Png;
    return std::nullopt;
}

std::uint64_t bytesOf(std::span<const Photo> photos) {
    std::uint64_t sum = 0;
    for (const Photo& photo : photos) sum += photo.bytes;
    return sum;
}

bool sameDescription(const Photo& a, const Photo& b) {
    return a.name == b.name && a.format == b.format && a.projection == b.projection && a.width == b.width &&
           a.height == b.height && a.pose == b.pose && a.angles == b.angles && a.station == b.station &&
           a.bytes == b.bytes;
}

}  // namespace scancast
