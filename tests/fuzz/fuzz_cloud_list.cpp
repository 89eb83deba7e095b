// What says which clouds there are behind a URL: pages of a bucket's objects, lists at web servers, and what a list's words mean. Nothing
// may crash; what is believed must be whole, and a word must lead to where a list may name something.
#include <cstdint>
#include <string>

#include "remote/cloud_list.hpp"
#include "remote/object_list.hpp"
#include "tests/fuzz/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    const std::string text(reinterpret_cast<const char*>(data), size);

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
    return 0;
}
