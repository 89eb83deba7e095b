// Which clouds a URL says that there are, now: objects of a bucket whose key begins with a prefix and goes on without a slash, or the
// words of a list at a web server or in a bucket. Asked again and again by its owner; what cannot be had, or is none, is an error and
// never an empty list.
//
// Owned by who looks, used on its thread. Place: URL → **remote listing** → which clouds are served.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "remote/remote_files.hpp"

namespace scancast {

struct ListedCloud {
    std::string url;    ///< with what is secret
    std::string shown;  ///< RemoteUrl::shown()
    std::string name;   ///< RemoteUrl::name()
    std::string state;  ///< another one when the object is another; of a list's, when the list is
    bool operator==(const ListedCloud&) const = default;
};

struct Listed {
    std::vector<ListedCloud> clouds;     ///< ordered by name, then by what is shown
    std::vector<std::string> leftOut{};  ///< what stands in it and is none, with the reason
};

class RemoteListing {
  public:
    static constexpr std::size_t mostClouds = 100'000;
    static constexpr std::uint64_t longestList = 4 << 20;  ///< bytes, of one answer

    /// s3://BUCKET, s3://BUCKET/PREFIX/: objects beneath it, whose name ends with .scan and does not begin with a dot. Any other
    /// URL: a list. InvalidArgument for what RemoteUrl::parse() refuses.
    static Expected<RemoteListing> create(const std::string& url);
    const std::string& shown() const { return shown_; }

    /// nullopt: the list is as it was, by its ETag or its content. Waits for the network, and no longer than a request may take (a list of
    /// many thousand objects: than some). Errors name it: those of RemoteFiles::fetch(); Malformed.
    Expected<std::optional<Listed>> look(RemoteFiles& remote);

  private:
    RemoteListing(RemoteUrl url, std::string shown, bool isPrefix)
        : url_(std::move(url)), shown_(std::move(shown)), isPrefix_(isPrefix) {}
    Expected<std::optional<Listed>> lookBeneath(RemoteFiles& remote) const;
    Expected<std::optional<Listed>> lookIn(RemoteFiles& remote);

    RemoteUrl url_;  // of a prefix: of something beneath it
    std::string shown_;
    bool isPrefix_ = false;
    // Of the list that was sound last.
    std::string etag_, text_;
    std::uint64_t edition_ = 0;
};

}  // namespace scancast
