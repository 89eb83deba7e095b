// The point stream's photos: what each is, as JSON, and where their bytes wait until the cloud is built. Pipeline: importer process →
// **point stream** → photos → facts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/scratch_file.hpp"
#include "protocol/error.hpp"
#include "renderer/cloud/stations/photo.hpp"

namespace scancast {

/// Bytes of photos in an unnamed temporary file, which stays as long as any of them is known. Used by one thread; what it gave
/// away, by any.
class PhotoSpool {
  public:
    /// nullopt: none are wanted.
    explicit PhotoSpool(std::optional<std::filesystem::path> folder) : folder_(std::move(folder)) {}

    /// A photo of so many bytes begins; what follows in take() is its.
    void begin(std::uint64_t bytes);
    void take(std::span<const std::byte> bytes);
    /// The photo that was begun; null where none are wanted, or there was no room: lost() says why.
    std::shared_ptr<const PhotoBytes> end();

    std::uint64_t lost() const { return lost_; }  ///< photos, for want of room
    /// Of that, for a note: which everybody reads, so it does not say where the folder is. nullptr: nothing was lost.
    const char* reason() const { return reason_; }

  private:
    void giveUp(const Error& error);

    std::optional<std::filesystem::path> folder_;
    std::shared_ptr<ScratchFile> file_;
    std::uint64_t at_ = 0, bytes_ = 0, taken_ = 0;  ///< of the photo that was begun
    bool keeping_ = false;
    std::uint64_t lost_ = 0;
    const char* reason_ = nullptr;
};

namespace point_stream {

inline constexpr std::size_t longestPhoto = 4096;  ///< bytes of one's description

/// All but its bytes.
std::string encodePhoto(const Photo& photo);
/// Trusts nothing in it but that there is such a station. Errors: Importer, without a file's name.
Expected<Photo> decodePhoto(std::string_view text);

}  // namespace point_stream

}  // namespace scancast
