// What is read of object storage and of a shared folder: URLs, heads and errors of answers, pieces on disk; which clouds there are, by
// pages of a bucket's objects and lists at web servers. Nothing may crash; what is believed must be whole, and what was asked for; what is
// shown of a URL must not have its query, and a word of a list must lead to where that may name something.
#include <cstdlib>
#include <string>

#include "remote/access.hpp"
#include "remote/answers.hpp"
#include "remote/cloud_list.hpp"
#include "remote/object_list.hpp"
#include "remote/piece_folder.hpp"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

void readLists(const std::string& text) {
    using namespace scancast;
    if (const auto page = parseObjectPage(text)) {
        require(text.find("</ListBucketResult") != text.npos || text.find("/>") != text.npos);
        require(page->objects.size() <= 1000);
        for (const ListedObject& object : page->objects) require(!object.key.empty());
    }
    const auto encrypted = *RemoteUrl::parse("https://x.org/area/list.txt?secret"),
               inS3 = *RemoteUrl::parse("s3://bucket/area/list");
    auto words = parseCloudList(text).value_or(std::vector<std::string>());
    words.push_back(text);
    for (const std::string& word : words) {
        if (const auto url = urlIn(encrypted, word)) {
            require(url->scheme() == RemoteUrl::Scheme::Https);
            require(url->whole().find_first_of("\r\n ") == std::string::npos);
        }
        if (const auto url = urlIn(inS3, word)) require(url->scheme() != RemoteUrl::Scheme::Http);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string text(reinterpret_cast<const char*>(data), size);

    readLists(text);
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
