// Where a cloud file in object storage is: what somebody wrote on a command line, judged before anything is asked for.
// A URL may be a secret by itself - the query of a presigned one is -, so what is told of it never has its query.
// Pure functions; any thread. Place: command line → **URL** → access → requests.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

/// Whether it is meant to be one: it begins with https://, http:// or s3://.
bool isRemoteUrl(std::string_view text);

class RemoteUrl {
  public:
    enum class Scheme : std::uint8_t { Http, Https, S3 };
    static constexpr std::size_t longest = 8192;

    /// InvalidArgument, with the way out and without the query: another scheme, a name and password in it, a fragment,
    /// characters that no URL has, no host or bucket, no file.
    static Expected<RemoteUrl> parse(std::string_view text);

    Scheme scheme() const { return scheme_; }
    /// With what is secret: for who asks for it, and nobody else.
    const std::string& whole() const { return whole_; }
    /// For people, logs and messages: without the query.
    const std::string& shown() const { return shown_; }
    /// The file's name: "town.scan".
    const std::string& name() const { return name_; }
    /// Of s3://BUCKET/KEY; empty otherwise.
    const std::string& bucket() const { return bucket_; }
    const std::string& key() const { return key_; }
    /// The name of the folder that it lies in, empty where that is the host or bucket: "town" of …/town/ept.json.
    std::string folderName() const;
    /// Signed for this object alone, by its query.
    bool isPresigned() const;
    /// What lies beside it, or beneath the folder that it is in, with the same query: `name` of letters, digits, -._ and slashes.
    /// InvalidArgument for any other, and where the URL gets too long.
    Expected<RemoteUrl> beside(std::string_view name) const;
    /// Names the object however its URL is signed.
    const std::string& identity() const { return identity_; }

  private:
    RemoteUrl() = default;
    static Expected<RemoteUrl> parseS3(std::string_view text);
    static Expected<RemoteUrl> parseHttp(std::string_view text, Scheme scheme);

    Scheme scheme_ = Scheme::Https;
    std::string whole_, shown_, name_, bucket_, key_, identity_;
};

/// What an argument of a command line is called in messages: a URL, of whatever scheme, without its query, name and password;
/// anything else as it is.
std::string shownArgument(std::string_view word);

/// Every byte but letters, digits and -._~ as %XX; slashes stay.
std::string percentEncoded(std::string_view path);

}  // namespace scancast
