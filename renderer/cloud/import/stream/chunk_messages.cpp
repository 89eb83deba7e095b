#include "renderer/cloud/import/stream/chunk_messages.hpp"

#include "files/bytes.hpp"
#include "protocol/text/grouped.hpp"

namespace scancast::chunk_messages {

namespace {

constexpr std::uint32_t requestMagic = 0x32514353, answerMagic = 0x31414353;  // "SCQ2", "SCA1"
constexpr std::array<ErrorCode, 4> errors{ErrorCode::Malformed, ErrorCode::Truncated, ErrorCode::Unsupported,
                                          ErrorCode::ResourceLimit};

std::uint32_t numberOf(ErrorCode code) {
    for (std::size_t i = 0; i < errors.size(); ++i)
        if (errors[i] == code) return std::uint32_t(i + 1);
    return 1;
}

}  // namespace

std::array<std::byte, requestHeadBytes> encode(const RequestHead& head) {
    std::array<std::byte, requestHeadBytes> bytes{};
    storeLe(bytes.data(), requestMagic);
    storeLe(bytes.data() + 4, std::uint32_t(head.packing));
    storeLe(bytes.data() + 8, head.pointFormat);
    storeLe(bytes.data() + 12, head.recordBytes);
    storeLe(bytes.data() + 16, head.laszipBytes);
    storeLe(bytes.data() + 24, head.points);
    storeLe(bytes.data() + 32, head.chunkBytes);
    return bytes;
}

std::array<std::byte, answerHeadBytes> encode(const AnswerHead& head) {
    std::array<std::byte, answerHeadBytes> bytes{};
    storeLe(bytes.data(), answerMagic);
    storeLe(bytes.data() + 4, head.error ? numberOf(*head.error) : 0);
    storeLe(bytes.data() + 8, head.bytes);
    return bytes;
}

Expected<RequestHead> parseRequest(std::span<const std::byte, requestHeadBytes> bytes) {
    if (loadLe<std::uint32_t>(bytes.data()) != requestMagic)
        return fail(ErrorCode::Malformed, "the request is none");
    const auto packing = loadLe<std::uint32_t>(bytes.data() + 4);
    RequestHead head;
    head.packing = Packing(packing);
    head.pointFormat = loadLe<std::uint32_t>(bytes.data() + 8);
    head.recordBytes = loadLe<std::uint32_t>(bytes.data() + 12);
    head.laszipBytes = loadLe<std::uint32_t>(bytes.data() + 16);
    head.points = loadLe<std::uint64_t>(bytes.data() + 24);
    head.chunkBytes = loadLe<std::uint64_t>(bytes.data() + 32);
    if (packing > std::uint32_t(Packing::Zstd) || loadLe<std::uint32_t>(bytes.data() + 20) != 0 ||
        head.pointFormat > 10 || head.recordBytes == 0 || head.recordBytes > 65535 ||
        head.laszipBytes > longestLaszip || head.points == 0 ||
        head.points > mostRecordBytes / head.recordBytes || head.chunkBytes > mostChunkBytes)
        return fail(ErrorCode::Malformed, "the request asks for more than there may be");
    return head;
}

Expected<AnswerHead> parseAnswer(std::span<const std::byte, answerHeadBytes> bytes,
                                 const RequestHead& request) {
    if (loadLe<std::uint32_t>(bytes.data()) != answerMagic)
        return fail(ErrorCode::Malformed, "its answer is none");
    const auto error = loadLe<std::uint32_t>(bytes.data() + 4);
    AnswerHead head;
    head.bytes = loadLe<std::uint64_t>(bytes.data() + 8);
    if (error > errors.size()) return fail(ErrorCode::Malformed, "its answer has an error that there is not");
    if (error > 0) head.error = errors[error - 1];
    const bool fits =
        error > 0 ? head.bytes <= longestReason : head.bytes == request.points * request.recordBytes;
    if (!fits)
        return fail(ErrorCode::Malformed,
                    "its answer has " + grouped(head.bytes) + " bytes, and was to have others");
    return head;
}

}  // namespace scancast::chunk_messages
