// What is read of object storage and of a shared folder: URLs, heads and errors of answers, pieces on disk. Nothing may crash; what
// is believed must be what was asked for, and what is shown of a URL must not have its query.
#include <string>

#include "remote/access.hpp"
#include "remote/answers.hpp"
#include "remote/piece_folder.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string text(reinterpret_cast<const char*>(data), size);

    (void)shownArgument(text);
    if (const auto url = RemoteUrl::parse(text)) {
        require(isRemoteUrl(text) && !url->name().empty() && url->name().find('/') == std::string::npos);
        if (url->scheme() != RemoteUrl::Scheme::S3)
            require(url->shown().find_first_of("?#\r\n ") == std::string::npos);
        const auto access = accessTo(*url, {.keyId = "id", .secret = "secret"});
        require(access && access->url.find_first_of("\r\n ") == std::string::npos);
        require(access->signing.empty() == (url->scheme() != RemoteUrl::Scheme::S3));
    }
    if (const auto range = parseContentRange(text))
        require(range->first <= range->last && range->last < range->total);
    require(s3ErrorCode(text).find_first_of("<>& \n") == std::string::npos);

    AnswerHead head;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find('\n', at), text.size() - 1);
        head.add(std::string_view(text).substr(at, end + 1 - at));
        at = end + 1;
    }
    const ObjectState expected{100, "\"tag\"", ""};
    if (const auto state = judge(head, 10, 20, &expected, text)) {
        require(*state == expected && head.status == 206);
        require(parseContentRange(head.contentRange) == (ContentRange{10, 29, 100}));
    }

    const auto bytes = std::as_bytes(std::span(text));
    if (const auto piece = unpackPiece("key", 1, bytes)) {
        const auto packed = packPiece("key", 1, *piece);
        require(std::equal(packed.begin(), packed.end(), bytes.begin(), bytes.end()));
    }
    return 0;
}
