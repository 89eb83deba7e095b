// What a front and the first rank of its job say to each other over a socket: heads of a fixed size, and the bodies behind them.
// Between processes of one program on one machine (ranks/draw/packing.hpp). Lengths are checked before anything is allocated. Pure
// functions; any thread. Place: front's device → **messages** → first rank → device of all ranks, and back.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "ranks/mpi/rank_bytes.hpp"
#include "renderer/image/frame.hpp"

namespace scancast {

enum class JobWord : std::uint32_t {
    Hello = 1,  ///< first rank, once: JobHello
    Beat,       ///< first rank, now and then: all ranks are there
    Open,       ///< front: a cloud to open, `id` its number; as OpenedClouds::openOnAll() takes it
    Opened,     ///< first rank's answer: JobOpened
    Draw,       ///< front: JobDrawing; `id` a picture's
    Cancel,     ///< front: nobody wants that picture; it may be answered all the same
    Picture,    ///< first rank's answer: JobPicture and its pixels …
    Failed,     ///< … or why there is none: an error
};

struct JobHead {
    JobWord word{};
    std::uint64_t id = 0;
    std::uint64_t bytes = 0;  ///< of the body that follows
};
inline constexpr std::size_t jobHeadBytes = 24;
using JobHeadBytes = std::array<std::byte, jobHeadBytes>;

JobHeadBytes packHead(const JobHead& head);
/// Malformed: no head, or one of a body that is longer than any of its kind is.
Expected<JobHead> unpackHead(const JobHeadBytes& bytes);

struct JobHello {
    std::string version;  ///< of the program
    std::uint32_t ranks = 0;
};
/// What became of a cloud that was to be opened.
struct JobOpened {
    std::string whyNot;          ///< empty: all ranks have opened it
    std::uint64_t capacity = 0;  ///< samples of it that all ranks together may hold for one picture
};
struct JobDrawing {
    bool pauses = false;                 ///< others are drawn within it
    std::span<const std::byte> drawing;  ///< packDrawing()'s
};
/// Behind it come width · height · 4 bytes of colours and, with depth, as many floats.
struct JobPicture {
    int width = 0, height = 0;
    bool depth = false;
    std::vector<StageTime> stages;

    std::uint64_t pixelBytes() const {
        return std::uint64_t(width) * std::uint64_t(height) * (depth ? 8 : 4);
    }
};
/// Of what stands before a picture's pixels: its own length, and so much at most.
inline constexpr std::uint32_t longestPictureHead = 64 << 10;

RankBytes pack(const JobHello& hello);
RankBytes pack(const JobOpened& opened);
RankBytes pack(const Error& error);
RankBytes pack(const JobPicture& picture);  ///< without its length

// Malformed: these are not its bytes.
Expected<JobHello> unpackHello(std::span<const std::byte> bytes);
Expected<JobOpened> unpackOpened(std::span<const std::byte> bytes);
Expected<Error> unpackError(std::span<const std::byte> bytes);
Expected<JobPicture> unpackPicture(std::span<const std::byte> bytes);
/// Refers to the bytes.
Expected<JobDrawing> unpackJobDrawing(std::span<const std::byte> bytes);

}  // namespace scancast
