// A photo that a scan brings along: what the scanner's camera, or one beside it, saw. Never drawn and never decoded here; people look
// at it beside the cloud. Plain values, and where the encoded bytes are. Pipeline: import → **photos** → facts → info, API, page.
//
// "Photo", because a picture is what this program renders.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// More are counted in a note and left out.
inline constexpr std::size_t mostPhotos = 4096;
/// Bytes of one, encoded; larger ones are counted in a note and left out.
inline constexpr std::uint64_t largestPhoto = std::uint64_t(128) << 20;
inline constexpr std::size_t longestPhotoName = 256;  ///< bytes; longer ones are cut

/// A photo's encoded bytes, wherever they wait: a temporary file, a cloud file. *Thread safety*: any thread may read.
class PhotoBytes {
  public:
    virtual ~PhotoBytes() = default;
    /// All of them. Errors: Io; Truncated or Malformed where the file around them is damaged.
    virtual Expected<std::vector<std::byte>> read() const = 0;
};

struct Photo {
    enum class Format : std::uint8_t { Jpeg, Png };
    enum class Projection : std::uint8_t {
        Visual,      ///< something to look at: nobody knows what a pixel shows
        Pinhole,     ///< as a camera sees: flat
        Spherical,   ///< equirectangular: equal angles across and down
        Cylindrical  ///< equal angles across, as a camera sees down
    };
    /// Where it was taken and what its middle shows: file coordinates; unit vectors at right angles.
    struct Pose {
        glm::dvec3 position{0}, forwards{1, 0, 0}, up{0, 0, 1};
        bool operator==(const Pose&) const = default;
    };

    std::string name{};  ///< for people, printable; may be empty
    Format format = Format::Jpeg;
    Projection projection = Projection::Visual;
    std::uint32_t width = 0, height = 0;     ///< pixels, as the scan says; 0: it does not
    std::optional<Pose> pose{};              ///< nullopt: not known
    std::array<double, 2> angles{0, 0};      ///< that it covers across and down, radians; 0: not known
    std::optional<std::uint32_t> station{};  ///< index of where it was taken; nullopt: at none, or not known
    std::uint64_t bytes = 0;                 ///< encoded
    std::shared_ptr<const PhotoBytes> data{};  ///< those; null only while they are on their way
};

/// Its name, or by its place in the list, from 0: "Photo 3".
inline std::string titleOf(const Photo& photo, std::size_t index) {
    return photo.name.empty() ? "Photo " + std::to_string(index + 1) : photo.name;
}

/// "jpeg", "png".
std::string_view name(Photo::Format format);
std::optional<Photo::Format> photoFormatOf(std::string_view name);
/// "image/jpeg", "image/png".
std::string_view mediaType(Photo::Format format);
/// "visual", "pinhole", "spherical", "cylindrical".
std::string_view name(Photo::Projection projection);
std::optional<Photo::Projection> photoProjectionOf(std::string_view name);

/// What the first bytes of a file (8 are enough) say that it is; nullopt: neither.
std::optional<Photo::Format> photoFormat(std::span<const std::byte> start);

/// Of all of them, encoded.
std::uint64_t bytesOf(std::span<const Photo> photos);

/// All but its bytes' content is the same.
bool sameDescription(const Photo& a, const Photo& b);

}  // namespace scancast
