// Where the pictures of a walk go: numbered JPEGs in a folder, or a video that ffmpeg makes of them. Each
// file appears under its name when it is complete.
//
// Owned by one command; one thread.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "files/unfinished_name.hpp"
#include "protocol/error.hpp"

namespace scancast::client {

/// Whether this name asks for a video: .mp4, .mkv, .webm, .mov or .avi.
bool isVideo(const std::string& path);

/// InvalidArgument for a name that asks for what is not written: a picture or a video of another kind. Any other name is a
/// folder's, and so is one that ends in a slash, or that a folder has already.
Expected<void> checkFilmName(const std::string& path);

class FilmWriter {
  public:
    /// `total` decides how many digits the numbers of files have. Errors: Io; NotFound when a video is asked
    /// for and there is no ffmpeg.
    static Expected<FilmWriter> create(const std::string& path, int total, double framesPerSecond);
    FilmWriter(FilmWriter&& other) noexcept;
    FilmWriter& operator=(FilmWriter&&) = delete;
    ~FilmWriter();  ///< gives an unfinished video up

    Expected<void> add(const std::vector<std::uint8_t>& jpeg);
    /// Waits until the video is whole.
    Expected<void> finish();

  private:
    FilmWriter(std::string path, int digits) : path_(std::move(path)), digits_(digits) {}
    Expected<void> startVideo(double framesPerSecond);
    Error videoFailed();
    int waitForProgram();

    std::string path_;
    UnfinishedName partial_;  ///< where an unfinished video is
    int digits_, count_ = 0;
    pid_t program_ = -1;
    int pipe_ = -1;
};

}  // namespace scancast::client
