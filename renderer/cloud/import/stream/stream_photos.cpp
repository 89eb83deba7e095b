#include "renderer/cloud/import/stream/stream_photos.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/stream_json.hpp"

namespace scancast {

namespace {

class SpooledPhoto final : public PhotoBytes {
  public:
    SpooledPhoto(std::shared_ptr<const ScratchFile> file, std::uint64_t at, std::uint64_t bytes)
        : file_(std::move(file)), at_(at), bytes_(bytes) {}

    Expected<std::vector<std::byte>> read() const override {
        std::vector<std::byte> all(bytes_);
        if (auto ok = file_->read(at_, all); !ok) return passOn(ok);
        return all;
    }

  private:
    const std::shared_ptr<const ScratchFile> file_;
    const std::uint64_t at_, bytes_;
};

}  // namespace

void PhotoSpool::begin(std::uint64_t bytes) {
    keeping_ = folder_ && reason_ == nullptr;
    lost_ += folder_ && !keeping_;
    bytes_ = bytes;
    taken_ = 0;
    if (!keeping_) return;
    if (!file_) {
        auto made = ScratchFile::create(*folder_, "--scratch or TMPDIR");
        if (!made) return giveUp(made.error());
        file_ = std::move(*made);
    }
    at_ = file_->reserve(bytes);
}

void PhotoSpool::take(std::span<const std::byte> bytes) {
    if (!keeping_) return;
    if (auto ok = file_->write(at_ + taken_, bytes); !ok) return giveUp(ok.error());
    taken_ += bytes.size();
}

std::shared_ptr<const PhotoBytes> PhotoSpool::end() {
    if (!keeping_ || taken_ != bytes_) return nullptr;
    return std::make_shared<SpooledPhoto>(file_, at_, bytes_);
}

void PhotoSpool::giveUp(const Error& error) {
    keeping_ = false;
    ++lost_;
    reason_ = error.code == ErrorCode::ResourceLimit
                  ? "there is no more room in the folder for temporary files (--scratch, or TMPDIR)"
                  : "nothing can be written to the folder for temporary files (--scratch, or TMPDIR)";
}

namespace point_stream {

namespace {

using Object = nlohmann::json;

tl::unexpected<Error> wrongPhoto(const std::string& reason) {
    return fail(ErrorCode::Importer, "a photo of its point stream is wrong: " + reason);
}

/// Takes the members of a description one by one; false for a value that is none for that member.
class PhotoMembers {
  public:
    bool take(const std::string& key, const Object& value) {
        if (key == "name") return text(value, photo.name);
        if (key == "format") return named(value, photoFormatOf, photo.format, hasFormat_);
        if (key == "projection") return named(value, photoProjectionOf, photo.projection, hasProjection_);
        if (key == "bytes") return whole(value, 1, largestPhoto, photo.bytes);
        if (key == "width") return whole(value, 0, mostPixels, photo.width);
        if (key == "height") return whole(value, 0, mostPixels, photo.height);
        if (key == "station") return whole(value, 0, mostPixels, photo.station.emplace());
        if (key == "angles") return angles(value);
        if (key == "position") return hasPosition_ = takeVector(value, pose_.position);
        if (key == "forwards") return hasForwards_ = takeVector(value, pose_.forwards);
        if (key == "up") return hasUp_ = takeVector(value, pose_.up);
        known = false;
        return false;
    }

    /// What is wrong with all of them together; nullptr: nothing.
    const char* judge() {
        if (!hasFormat_) return "it has no format";
        if (!hasProjection_) return "it has no projection";
        if (photo.bytes == 0) return "it does not say how many bytes it has";
        if (hasPosition_ != hasForwards_ || hasForwards_ != hasUp_)
            return "a pose is position, forwards and up together";
        if (!hasPosition_) return nullptr;
        const auto unit = [](const glm::dvec3& v) { return std::abs(glm::length(v) - 1) <= 1e-6; };
        if (!unit(pose_.forwards) || !unit(pose_.up) || std::abs(glm::dot(pose_.forwards, pose_.up)) > 1e-6)
            return "forwards and up are no unit vectors at right angles";
        photo.pose = pose_;
        return nullptr;
    }

    Photo photo{};
    bool known = true;  ///< the member's name

  private:
    static constexpr std::uint64_t mostPixels = std::numeric_limits<std::uint32_t>::max();

    static bool text(const Object& value, std::string& into) {
        if (!value.is_string()) return false;
        into = printableText(value.get_ref<const std::string&>(), longestPhotoName);
        return true;
    }
    template <class T>
    static bool named(const Object& value, std::optional<T> (*find)(std::string_view), T& into, bool& has) {
        const auto found = value.is_string() ? find(value.get_ref<const std::string&>()) : std::nullopt;
        if (found) into = *found;
        return has = found.has_value();
    }
    template <class T>
    static bool whole(const Object& value, std::uint64_t least, std::uint64_t most, T& into) {
        if (!value.is_number_unsigned()) return false;
        const auto number = value.get<std::uint64_t>();
        if (number < least || number > most) return false;
        into = static_cast<T>(number);
        return true;
    }
    bool angles(const Object& value) {
        if (!value.is_array() || value.size() != 2) return false;
        for (std::size_t i = 0; i < 2; ++i) {
            if (!value[i].is_number()) return false;
            photo.angles[i] = value[i].get<double>();
            if (!(photo.angles[i] >= 0 && photo.angles[i] <= 2 * std::numbers::pi + 1e-6)) return false;
        }
        return true;
    }

    Photo::Pose pose_{};
    bool hasFormat_ = false, hasProjection_ = false;
    bool hasPosition_ = false, hasForwards_ = false, hasUp_ = false;
};

}  // namespace

std::string encodePhoto(const Photo& photo) {
    Object object{{"name", printableText(photo.name, longestPhotoName)},
                  {"format", name(photo.format)},
                  {"projection", name(photo.projection)},
                  {"width", photo.width},
                  {"height", photo.height},
                  {"angles", photo.angles},
                  {"bytes", photo.bytes}};
    if (photo.station) object["station"] = *photo.station;
    if (photo.pose) {
        object["position"] = numbers(photo.pose->position);
        object["forwards"] = numbers(photo.pose->forwards);
        object["up"] = numbers(photo.pose->up);
    }
    return object.dump();
}

Expected<Photo> decodePhoto(std::string_view text) {
    const auto object = Object::parse(text, nullptr, false);
    if (!object.is_object()) return wrongPhoto("it is no JSON object");
    PhotoMembers members;
    for (const auto& [key, value] : object.items()) {
        const bool taken = members.take(key, value);
        if (taken) continue;
        const auto called = quotedText(key);
        return wrongPhoto(members.known ? "its " + called + " is none" : called + " is not known of one");
    }
    if (const char* reason = members.judge()) return wrongPhoto(reason);
    return std::move(members.photo);
}

}  // namespace point_stream

}  // namespace scancast
