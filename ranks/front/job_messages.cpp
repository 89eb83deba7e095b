#include "ranks/front/job_messages.hpp"

#include <cstring>

#include "ranks/draw/packing.hpp"

namespace scancast {
namespace {

constexpr std::uint32_t headMagic = 0x4a524353;  // "SCRJ"

struct PackedHead {
    std::uint32_t magic = headMagic, word = 0;
    std::uint64_t id = 0, bytes = 0;
};
static_assert(sizeof(PackedHead) == jobHeadBytes);

constexpr std::uint64_t longestText = 64 << 10;
constexpr std::uint64_t longestDrawing = 256 << 20;
constexpr std::uint64_t longestPicture = std::uint64_t(4) << 30;
constexpr int longestSide = 1 << 20;

/// Bytes of a body of its kind, at the most; 0 for a kind that there is not.
std::uint64_t longestBody(JobWord word) {
    switch (word) {
        case JobWord::Hello:
        case JobWord::Opened:
        case JobWord::Failed:
            return longestText;
        case JobWord::Open:
            return longestDrawing;
        case JobWord::Draw:
            return longestDrawing;
        case JobWord::Picture:
            return longestPicture;
        case JobWord::Beat:
        case JobWord::Cancel:
            break;
    }
    return 0;
}

tl::unexpected<Error> malformed() {
    return fail(
        ErrorCode::Malformed,
        "The ranks and the program before them do not understand each other; are all of one version?");
}

/// What `read` takes out of the bytes, if it is all there and nothing else is.
template <class T, class Read>
Expected<T> unpackAll(std::span<const std::byte> bytes, const Read& read) {
    Unpacker in(bytes);
    T value;
    read(in, value);
    if (!in.sound()) return malformed();
    return value;
}

}  // namespace

JobHeadBytes packHead(const JobHead& head) {
    const PackedHead packed{headMagic, std::uint32_t(head.word), head.id, head.bytes};
    JobHeadBytes bytes;
    std::memcpy(bytes.data(), &packed, sizeof packed);
    return bytes;
}

Expected<JobHead> unpackHead(const JobHeadBytes& bytes) {
    PackedHead packed;
    std::memcpy(&packed, bytes.data(), sizeof packed);
    const bool known =
        packed.word >= std::uint32_t(JobWord::Hello) && packed.word <= std::uint32_t(JobWord::Failed);
    if (packed.magic != headMagic || !known) return malformed();
    const JobHead head{JobWord(packed.word), packed.id, packed.bytes};
    if (head.bytes > longestBody(head.word)) return malformed();
    return head;
}

RankBytes pack(const JobHello& hello) {
    Packer out;
    out.putText(hello.version);
    out.put(hello.ranks);
    return std::move(out.bytes);
}

RankBytes pack(const JobOpened& opened) {
    Packer out;
    out.putText(std::string_view(opened.whyNot).substr(0, longestText / 2));
    out.put(opened.capacity);
    return std::move(out.bytes);
}

RankBytes pack(const Error& error) {
    Packer out;
    out.put(std::uint8_t(error.code));
    out.putText(std::string_view(error.message).substr(0, longestText / 2));
    out.putText(std::string_view(error.field).substr(0, longestText / 4));
    return std::move(out.bytes);
}

RankBytes pack(const JobPicture& picture) {
    Packer out;
    out.put(std::int32_t(picture.width));
    out.put(std::int32_t(picture.height));
    out.put(std::uint8_t(picture.depth));
    out.put(std::uint32_t(picture.stages.size()));
    for (const StageTime& stage : picture.stages) {
        out.putText(stage.name);
        out.put(stage.milliseconds);
    }
    return std::move(out.bytes);
}

Expected<JobHello> unpackHello(std::span<const std::byte> bytes) {
    return unpackAll<JobHello>(bytes, [](Unpacker& in, JobHello& hello) {
        in.getText(hello.version);
        in.get(hello.ranks);
    });
}

Expected<JobOpened> unpackOpened(std::span<const std::byte> bytes) {
    return unpackAll<JobOpened>(bytes, [](Unpacker& in, JobOpened& opened) {
        in.getText(opened.whyNot);
        in.get(opened.capacity);
    });
}

Expected<Error> unpackError(std::span<const std::byte> bytes) {
    return unpackAll<Error>(bytes, [](Unpacker& in, Error& error) {
        std::uint8_t code = 0;
        in.get(code);
        if (code > std::uint8_t(ErrorCode::Internal)) in.fail();
        error.code = ErrorCode(code);
        in.getText(error.message);
        in.getText(error.field);
    });
}

Expected<JobPicture> unpackPicture(std::span<const std::byte> bytes) {
    return unpackAll<JobPicture>(bytes, [](Unpacker& in, JobPicture& picture) {
        std::int32_t width = 0, height = 0;
        std::uint8_t depth = 0;
        std::uint32_t stages = 0;
        in.get(width);
        in.get(height);
        in.get(depth);
        in.get(stages);
        if (width < 1 || height < 1 || width > longestSide || height > longestSide) in.fail();
        for (std::uint32_t i = 0; i < stages && !in.failed(); ++i) {
            StageTime& stage = picture.stages.emplace_back();
            in.getText(stage.name);
            in.get(stage.milliseconds);
        }
        picture.width = width;
        picture.height = height;
        picture.depth = depth != 0;
    });
}

Expected<JobDrawing> unpackJobDrawing(std::span<const std::byte> bytes) {
    if (bytes.empty()) return malformed();
    return JobDrawing{bytes.front() != std::byte{0}, bytes.subspan(1)};
}

}  // namespace scancast
