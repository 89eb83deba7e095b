#include "importers/e57/photos.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "files/bytes.hpp"
#include "importers/e57/scan_description.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/stations/station.hpp"

namespace scancast::import_e57 {

namespace {

constexpr std::uint64_t blobHeadBytes = 16;  ///< kind of section, reserved, its length
constexpr std::byte blobSection{0};

struct Representation {
    const char* element;
    Photo::Projection projection;
};
/// The ones that say most come first.
constexpr std::array representations{
    Representation{"sphericalRepresentation", Photo::Projection::Spherical},
    Representation{"pinholeRepresentation", Photo::Projection::Pinhole},
    Representation{"cylindricalRepresentation", Photo::Projection::Cylindrical},
    Representation{"visualReferenceRepresentation", Photo::Projection::Visual}};

std::uint32_t pixels(const XmlElement& parent, const char* name) {
    const double value = valueOf(parent, name).value_or(0);
    return value >= 1 && value <= 1e6 ? static_cast<std::uint32_t>(value) : 0;
}

/// How large a pixel is, how far away the surface that it lies on is, and which pixel is straight ahead; 0 where there is no telling.
struct Optics {
    double width = 0, height = 0;  ///< of a pixel: radians, or the unit of `distance`
    double distance = 0;
    double aheadX = 0, aheadY = 0;  ///< pixels from the upper left corner
};

Optics opticsOf(const XmlElement& representation, const Photo& photo) {
    const auto positive = [&](const char* name) {
        const double value = valueOf(representation, name).value_or(0);
        return value > 0 && value < 1e9 ? value : 0;
    };
    const auto ahead = [&](const char* name, std::uint32_t size) {
        const double value = valueOf(representation, name).value_or(-1);
        return value >= 0 && value <= size ? value : size / 2.0;
    };
    return {.width = positive("pixelWidth"),
            .height = positive("pixelHeight"),
            .distance = photo.projection == Photo::Projection::Cylindrical ? positive("radius")
                                                                           : positive("focalLength"),
            .aheadX = ahead("principalPointX", photo.width),
            .aheadY = ahead("principalPointY", photo.height)};
}

/// The angle between the two edges of something flat.
double flatAngle(double ahead, double size, double pixel, double distance) {
    if (!(distance > 0 && pixel > 0)) return 0;
    return std::atan(ahead * pixel / distance) + std::atan((size - ahead) * pixel / distance);
}

/// 0 where it would be more than there is.
double turn(double angle, double most) {
    return angle <= most * 1.01 ? std::min(angle, most) : 0;
}

std::array<double, 2> anglesOf(const Photo& photo, const Optics& optics) {
    using std::numbers::pi;
    const double width = photo.width, height = photo.height;
    switch (photo.projection) {
        case Photo::Projection::Visual:
            return {0, 0};
        case Photo::Projection::Pinhole:
            return {flatAngle(optics.aheadX, width, optics.width, optics.distance),
                    flatAngle(optics.aheadY, height, optics.height, optics.distance)};
        case Photo::Projection::Spherical:
            return {turn(width * optics.width, 2 * pi), turn(height * optics.height, pi)};
        case Photo::Projection::Cylindrical:
            return {turn(width * optics.width, 2 * pi),
                    flatAngle(optics.aheadY, height, optics.height, optics.distance)};
    }
    return {0, 0};
}

/// What the middle of the photo shows, in the axes of its camera: a flat one looks along -z, y up; the others along x, z up
/// (ASTM E2807, 8.4.8 and following). nullopt: numbers that no camera has.
std::optional<Photo::Pose> poseOf(const Pose& pose, const Photo& photo, const Optics& optics) {
    const bool flat = photo.projection == Photo::Projection::Pinhole;
    glm::dvec3 ahead = flat ? glm::dvec3(0, 0, -1) : glm::dvec3(1, 0, 0);
    if (flat && optics.distance > 0 && optics.width > 0 && optics.height > 0)
        ahead = {(photo.width / 2.0 - optics.aheadX) * optics.width,
                 (optics.aheadY - photo.height / 2.0) * optics.height, -optics.distance};
    const auto forwards = unitVector(pose.rotation * ahead);
    if (!forwards) return std::nullopt;
    const glm::dvec3 above = pose.rotation * (flat ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1));
    const glm::dvec3 sideways = above - glm::dot(above, *forwards) * *forwards;
    const auto up = unitVector(sideways);
    if (!up || glm::length(sideways) < 1e-6 || std::abs(glm::dot(*up, *forwards)) > 1e-7) return std::nullopt;
    return Photo::Pose{pose.translation, *forwards, *up};
}

const XmlElement* blobOf(const XmlElement& representation) {
    for (const char* name : {"jpegImage", "pngImage"})
        if (const auto* const blob = representation.child(name)) return blob;
    return nullptr;
}

}  // namespace

std::optional<PhotoDescription> describePhoto(const XmlElement& picture) {
    for (const auto& [element, projection] : representations) {
        const auto* const representation = picture.child(element);
        const auto* const blob = representation != nullptr ? blobOf(*representation) : nullptr;
        if (blob == nullptr) continue;
        PhotoDescription result;
        Photo& photo = result.photo;
        if (const auto* const name = picture.child("name"))
            photo.name = printableText(name->text, longestPhotoName);
        if (const auto* const scan = picture.child("associatedData3DGuid")) result.scan = scan->text;
        result.section = numberIn<std::uint64_t>(blob->attribute("fileOffset"), 0).value_or(0);
        result.bytes = numberIn<std::uint64_t>(blob->attribute("length"), 0).value_or(0);
        photo.projection = projection;
        photo.width = pixels(*representation, "imageWidth");
        photo.height = pixels(*representation, "imageHeight");
        if (projection == Photo::Projection::Visual) return result;
        const Optics optics = opticsOf(*representation, photo);
        photo.angles = anglesOf(photo, optics);
        if (const auto* const pose = picture.child("pose"))
            if (const auto read = describePose(*pose, {}); read && !read->wasZero)
                photo.pose = poseOf(*read, photo, optics);
        return result;
    }
    return std::nullopt;
}

Photos::Photos(PagedFile& file, const std::vector<PhotoDescription>& described, std::uint64_t more,
               const std::function<std::optional<std::uint32_t>(const std::string& guid)>& stationOf)
    : file_(file) {
    constexpr const char* tooMany = "more than are kept";
    if (more > 0) leftOut_[tooMany] = more;
    for (const PhotoDescription& one : described) {
        Found found{.photo = one.photo};
        const char* reason = found_.size() == mostPhotos ? tooMany : find(one, found);
        if (reason != nullptr) {
            ++leftOut_[reason];
            continue;
        }
        found.photo.station = stationOf(one.scan);
        bytes_ += found.photo.bytes;
        found_.push_back(std::move(found));
    }
}

const char* Photos::find(const PhotoDescription& described, Found& found) {
    constexpr const char* noPlace = "its place in the file is none";
    if (described.bytes == 0) return "it has no bytes";
    if (described.bytes > largestPhoto) return "larger than 128 MiB";
    const auto at = file_.logicalOffset(described.section, "a photo");
    if (!at) return noPlace;
    const auto room = file_.logicalBytes() - *at;
    if (room < blobHeadBytes || described.bytes > room - blobHeadBytes) return noPlace;
    if (described.bytes > file_.logicalBytes() - std::min(bytes_, file_.logicalBytes()))
        return "together they have more bytes than the file";
    std::array<std::byte, blobHeadBytes + 8> start{};
    const auto looked = std::min<std::uint64_t>(start.size(), blobHeadBytes + described.bytes);
    if (!file_.read(*at, std::span(start).first(looked))) return "damaged";
    if (start[0] != blobSection) return noPlace;
    const auto format = photoFormat(std::span(start).first(looked).subspan(blobHeadBytes));
    if (!format) return "neither JPEG nor PNG";
    found.photo.format = *format;
    found.photo.bytes = described.bytes;
    found.at = *at + blobHeadBytes;
    return nullptr;
}

Expected<void> Photos::describe(PointStreamWriter& writer) const {
    for (const Found& found : found_)
        if (auto ok = writer.writePhoto(found.photo); !ok) return ok;
    return {};
}

// Each is read whole before a byte of it is sent: what was begun cannot be taken back.
Expected<void> Photos::send(PointStreamWriter& writer) {
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i < found_.size(); ++i) {
        bytes.resize(found_[i].photo.bytes);
        if (!file_.read(found_[i].at, bytes)) continue;  // damaged there; who reads counts what did not come
        if (auto ok = writer.startPhotoBytes(static_cast<std::uint32_t>(i)); !ok) return ok;
        if (auto ok = writer.writePhotoPiece(bytes); !ok) return ok;
    }
    for (const auto& [reason, count] : leftOut_) {
        const auto note =
            fmt::format("{} {} left out: {}", grouped(count), count == 1 ? "photo" : "photos", reason);
        if (auto ok = writer.writeNote(note); !ok) return ok;
    }
    return {};
}

}  // namespace scancast::import_e57
