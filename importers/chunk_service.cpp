#include "importers/chunk_service.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

#include "threads/guarded.hpp"

namespace scancast {

namespace {

using namespace chunk_messages;

/// How many bytes came; fewer than there is room for only at the end.
std::size_t readFull(int from, std::span<std::byte> into) {
    std::size_t done = 0;
    while (done < into.size()) {
        const auto got = ::read(from, into.data() + done, into.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        done += std::size_t(got);
    }
    return done;
}

bool writeFull(int to, std::span<const std::byte> bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
        const auto written = ::write(to, bytes.data() + done, bytes.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        done += std::size_t(written);
    }
    return true;
}

bool answer(int to, const Expected<std::vector<std::byte>>& records) {
    AnswerHead head;
    std::span<const std::byte> body;
    if (records) {
        body = *records;
    } else {
        const std::string& reason = records.error().message;
        body = std::as_bytes(std::span(reason)).first(std::min<std::size_t>(reason.size(), longestReason));
        head.error = records.error().code;
    }
    head.bytes = body.size();
    return writeFull(to, encode(head)) && writeFull(to, body);
}

}  // namespace

bool serveChunks(int requests, int answers, const DecodeChunk& decode) {
    std::vector<std::byte> laszip, chunk;
    while (true) {
        std::array<std::byte, requestHeadBytes> start;
        const std::size_t got = readFull(requests, start);
        if (got == 0) return true;
        if (got < start.size()) return false;
        const auto head = parseRequest(start);
        if (!head) return false;
        laszip.resize(head->laszipBytes);
        chunk.resize(std::size_t(head->chunkBytes));
        if (readFull(requests, laszip) < laszip.size() || readFull(requests, chunk) < chunk.size())
            return false;
        if (!answer(answers, guarded("Decoding", [&] { return decode(*head, laszip, chunk); }))) return false;
    }
}

}  // namespace scancast
