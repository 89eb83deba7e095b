// What a front and the first rank of its job say to each other, one message behind another, as either end reads them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "ranks/draw/packed_drawing.hpp"
#include "ranks/front/job_messages.hpp"
#include "tests/fuzz/require.hpp"

using namespace scancast;

namespace {

/// What is sound is packed as it came.
template <class T>
void isPackedAgain(const Expected<T>& value, std::span<const std::byte> bytes) {
    // (Of what is very long, sentences are cut.)
    if (value && bytes.size() < 10000) require(std::ranges::equal(pack(*value), bytes));
}

void readDrawing(std::span<const std::byte> body) {
    const auto asked = unpackJobDrawing(body);
    if (!asked) return;
    const auto drawing = unpackDrawing(asked->drawing);
    if (!drawing) return;
    require(!(*drawing)->drawing.cuts.empty() &&
            (*drawing)->drawing.passes.size() == (*drawing)->passes.size());
    require((*drawing)->allCuts().size() == (*drawing)->cuts.size() + ((*drawing)->sun ? 1 : 0));
    // It is of a cloud that has nodes, or it is refused.
    if (std::ranges::any_of((*drawing)->allCuts(),
                            [](const CutView* view) { return !view->cut.runs.empty(); }))
        require(!(*drawing)->findNodes(Octree{}));
}

void readPicture(std::span<const std::byte> body) {
    std::uint32_t length = 0;
    if (body.size() < sizeof length) return;
    std::memcpy(&length, body.data(), sizeof length);
    body = body.subspan(sizeof length);
    if (length > std::min<std::size_t>(body.size(), longestPictureHead)) return;
    if (const auto picture = unpackPicture(body.first(length)))
        require(picture->width > 0 && picture->height > 0 && picture->pixelBytes() > 0);
}

void readBody(JobWord word, std::span<const std::byte> body) {
    switch (word) {
        case JobWord::Hello:
            return isPackedAgain(unpackHello(body), body);
        case JobWord::Opened:
            return isPackedAgain(unpackOpened(body), body);
        case JobWord::Failed:
            return isPackedAgain(unpackError(body), body);
        case JobWord::Draw:
            return readDrawing(body);
        case JobWord::Picture:
            return readPicture(body);
        case JobWord::Beat:
        case JobWord::Open:
        case JobWord::Cancel:
            return;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    auto left = std::as_bytes(std::span(data, size));
    while (left.size() >= jobHeadBytes) {
        JobHeadBytes bytes;
        std::ranges::copy(left.first(jobHeadBytes), bytes.begin());
        left = left.subspan(jobHeadBytes);
        const auto head = unpackHead(bytes);
        if (!head) return 0;
        require(packHead(*head) == bytes);
        const auto body = left.first(std::min<std::uint64_t>(head->bytes, left.size()));
        readBody(head->word, body);
        left = left.subspan(body.size());
    }
    return 0;
}
