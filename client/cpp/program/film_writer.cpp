#include "client/cpp/program/film_writer.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "client/cpp/program/command.hpp"
#include "files/system_error.hpp"

extern char** environ;

namespace scancast::client {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> videoEndings{".mp4", ".mkv", ".webm", ".mov", ".avi"};
/// Of pictures and videos that somebody might hope for.
constexpr std::array<std::string_view, 22> otherEndings{
    ".gif",  ".apng", ".png", ".jpg", ".jpeg", ".webp", ".avif", ".jxl", ".heic", ".bmp", ".tif",
    ".tiff", ".svg",  ".pdf", ".exr", ".mpg",  ".mpeg", ".m4v",  ".ogv", ".flv",  ".wmv", ".ts"};

bool isOneOf(std::span<const std::string_view> endings, std::string_view ending) {
    return std::ranges::find(endings, ending) != endings.end();
}

/// In lower case, with its dot; empty of a name that ends in a slash.
std::string endingOf(const std::string& path) {
    std::string ending = fs::path(path).extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending;
}

std::string numbered(const std::string& folder, int number, int digits) {
    auto text = std::to_string(number);
    text.insert(0, std::max(0, digits - static_cast<int>(text.size())), '0');
    return (fs::path(folder) / ("frame-" + text + ".jpg")).string();
}

/// "flight.mp4" → "flight.partial-123.mp4": the ending tells ffmpeg the format.
std::string partialName(const std::string& path) {
    const fs::path whole(path);
    const auto name =
        whole.stem().string() + ".partial-" + std::to_string(getpid()) + whole.extension().string();
    return (whole.parent_path() / name).string();
}

/// Starts ffmpeg with its standard input at the other end of `input`; -1 when there is none.
pid_t startProgram(std::vector<std::string> words, int input) {
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    pid_t program = -1;
    const int failed = posix_spawnp(&program, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    return failed ? -1 : program;
}

}  // namespace

bool isVideo(const std::string& path) {
    return isOneOf(videoEndings, endingOf(path));
}

Expected<void> checkFilmName(const std::string& path) {
    std::error_code error;
    const std::string ending = endingOf(path);
    if (!isOneOf(otherEndings, ending) || fs::is_directory(path, error)) return {};
    return fail(ErrorCode::InvalidArgument,
                path + ": " + ending +
                    " cannot be written. Name a folder for numbered JPEGs, such as frames/, or a video that "
                    "ends in .mp4, .mkv, .webm, .mov or .avi",
                "output");
}

Expected<FilmWriter> FilmWriter::create(const std::string& path, int total, double framesPerSecond) {
    FilmWriter writer(path, std::max(3, static_cast<int>(std::to_string(total).size())));
    if (isVideo(path)) {
        if (auto ok = writer.startVideo(framesPerSecond); !ok) return passOn(ok);
        return writer;
    }
    std::error_code error;
    fs::create_directories(path, error);
    if (error) return fail(ErrorCode::Io, "cannot make the folder " + path + ": " + error.message());
    return writer;
}

FilmWriter::FilmWriter(FilmWriter&& other) noexcept
    : path_(std::move(other.path_)),
      partial_(std::move(other.partial_)),
      digits_(other.digits_),
      count_(other.count_),
      program_(std::exchange(other.program_, -1)),
      pipe_(std::exchange(other.pipe_, -1)) {}

FilmWriter::~FilmWriter() {
    if (program_ > 0) kill(program_, SIGTERM);
    waitForProgram();
}

Expected<void> FilmWriter::startVideo(double framesPerSecond) {
    // A socket, not a pipe: writing to a program that has ended is then an error and no signal.
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        return fail(ErrorCode::Io, std::string("cannot talk to ffmpeg: ") + std::strerror(errno));
    pipe_ = ends[0];
    partial_ = UnfinishedName(partialName(path_));
    // Sides must be even for the most common pixel format.
    program_ =
        startProgram({"ffmpeg", "-y", "-loglevel", "error", "-f", "image2pipe", "-c:v", "mjpeg", "-framerate",
                      std::to_string(framesPerSecond), "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                      "-pix_fmt", "yuv420p", "file:" + partial_.name()},
                     ends[1]);
    close(ends[1]);
    if (program_ > 0) return {};
    return fail(ErrorCode::NotFound, "there is no ffmpeg to make " + path_ +
                                         ": install the package ffmpeg, or give a folder for numbered JPEGs");
}

Expected<void> FilmWriter::add(const std::vector<std::uint8_t>& jpeg) {
    ++count_;
    if (program_ <= 0) return writeFile(numbered(path_, count_, digits_), jpeg);
    for (std::size_t done = 0; done < jpeg.size();) {
        const auto sent = send(pipe_, jpeg.data() + done, jpeg.size() - done, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0) return tl::unexpected(videoFailed());
        done += static_cast<std::size_t>(sent);
    }
    return {};
}

Expected<void> FilmWriter::finish() {
    if (program_ <= 0) return {};
    if (waitForProgram() != 0) return tl::unexpected(videoFailed());
    if (const int refused = partial_.become(path_))
        return fail(ErrorCode::Io, path_ + " cannot get its name: " + systemReason(refused));
    return {};
}

Error FilmWriter::videoFailed() {
    waitForProgram();
    return {ErrorCode::Io, "ffmpeg could not make " + path_ + "; what it said stands above", {}};
}

int FilmWriter::waitForProgram() {
    if (pipe_ >= 0) close(std::exchange(pipe_, -1));
    if (program_ <= 0) return 0;
    int status = 0;
    while (waitpid(program_, &status, 0) < 0 && errno == EINTR) {
    }
    program_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace scancast::client
