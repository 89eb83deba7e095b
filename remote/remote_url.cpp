#include "remote/remote_url.hpp"

#include <algorithm>
#include <array>

namespace scancast {
namespace {

constexpr std::array<std::pair<std::string_view, RemoteUrl::Scheme>, 3> schemes{{
    {"https://", RemoteUrl::Scheme::Https},
    {"http://", RemoteUrl::Scheme::Http},
    {"s3://", RemoteUrl::Scheme::S3},
}};

char lowered(char c) {
    return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
}

bool startsWith(std::string_view text, std::string_view scheme) {
    return text.size() >= scheme.size() && std::equal(scheme.begin(), scheme.end(), text.begin(),
                                                      [](char a, char b) { return a == lowered(b); });
}

bool isPlain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '_' || c == '~';
}

tl::unexpected<Error> refused(std::string_view shown, std::string_view why) {
    return fail(ErrorCode::InvalidArgument, std::string(shown) + ": " + std::string(why));
}

std::string lastComponent(std::string_view path) {
    return std::string(path.substr(path.rfind('/') + 1));
}

int hexDigit(char c) {
    const char low = lowered(c);
    return c >= '0' && c <= '9' ? c - '0' : low >= 'a' && low <= 'f' ? low - 'a' + 10 : -1;
}

/// %20 as what it stands for, where that can stand in a name.
std::string percentDecoded(std::string_view text) {
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const int high = text[i] == '%' && i + 2 < text.size() ? hexDigit(text[i + 1]) : -1;
        const int low = high >= 0 ? hexDigit(text[i + 2]) : -1;
        const int byte = low >= 0 ? high * 16 + low : -1;
        if (byte < 0x20 || byte == 0x7f || byte == '/') {
            decoded += text[i];
            continue;
        }
        decoded += char(byte);
        i += 2;
    }
    return decoded;
}

/// Who signs a URL signs it anew each time: what a bucket calls the object is the same.
bool isSigned(std::string_view query) {
    return query.find("X-Amz-Signature=") != query.npos || query.find("X-Goog-Signature=") != query.npos;
}

/// Everything before the query and the fragment, and nothing of a name and password.
std::string shownOf(std::string_view text) {
    std::string shown(text.substr(0, text.find_first_of("?#")));
    const auto host = shown.find("://") + 3;
    const auto path = std::min(shown.find('/', host), shown.size());
    const auto at = shown.rfind('@', path == 0 ? 0 : path - 1);
    if (at != shown.npos && at >= host && at < path) shown.erase(host, at + 1 - host);
    return shown;
}

}  // namespace

bool isRemoteUrl(std::string_view text) {
    return std::ranges::any_of(schemes, [&](const auto& scheme) { return startsWith(text, scheme.first); });
}

std::string shownArgument(std::string_view word) {
    if (isRemoteUrl(word)) return shownOf(word);
    const auto scheme = word.find("://");
    if (scheme == word.npos) return std::string(word);
    // Of another scheme: nobody knows where its name and password end, so nothing before the last @ is told.
    const auto at = word.rfind('@');
    const auto host = at == word.npos || at < scheme ? scheme + 3 : at + 1;
    const std::string_view behind = word.substr(host);
    return std::string(word.substr(0, scheme + 3)) +
           std::string(behind.substr(0, behind.find_first_of("?#")));
}

std::string percentEncoded(std::string_view path) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string encoded;
    for (const char c : path) {
        if (isPlain(c) || c == '/') {
            encoded += c;
            continue;
        }
        const auto byte = static_cast<unsigned char>(c);
        encoded += {'%', digits[byte >> 4], digits[byte & 15]};
    }
    return encoded;
}

Expected<RemoteUrl> RemoteUrl::parse(std::string_view text) {
    for (const auto& [name, scheme] : schemes) {
        if (!startsWith(text, name)) continue;
        if (text.size() > longest) return refused(name, "the URL is longer than 8192 characters");
        if (std::ranges::any_of(text,
                                [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }))
            return refused(name, "the URL has control characters in it");
        return scheme == Scheme::S3 ? parseS3(text) : parseHttp(text, scheme);
    }
    return fail(ErrorCode::InvalidArgument, "A URL begins with https://, http:// or s3://.");
}

Expected<RemoteUrl> RemoteUrl::parseS3(std::string_view text) {
    RemoteUrl url;
    url.scheme_ = Scheme::S3;
    const std::string_view rest = text.substr(5);
    const auto slash = std::min(rest.find('/'), rest.size());
    url.bucket_ = rest.substr(0, slash);
    url.key_ = rest.substr(std::min(slash + 1, rest.size()));
    constexpr std::size_t shortestBucket = 3, longestBucket = 63, longestKey = 1024;
    const bool isBucket = url.bucket_.size() >= shortestBucket && url.bucket_.size() <= longestBucket &&
                          url.bucket_.front() != '.' && url.bucket_.find("..") == url.bucket_.npos &&
                          std::ranges::all_of(url.bucket_, [](char c) { return isPlain(c) && c != '~'; });
    if (!isBucket) return refused("s3://", "what follows is no bucket's name; write s3://BUCKET/KEY");
    if (url.key_.empty() || url.key_.ends_with('/') || url.key_.size() > longestKey)
        return refused("s3://" + url.bucket_, "names no object; write s3://BUCKET/KEY");
    url.whole_ = url.shown_ = url.identity_ = "s3://" + url.bucket_ + "/" + url.key_;
    url.name_ = lastComponent(url.key_);
    return url;
}

Expected<RemoteUrl> RemoteUrl::parseHttp(std::string_view text, Scheme scheme) {
    RemoteUrl url;
    url.scheme_ = scheme;
    url.shown_ = shownOf(text);
    const std::string_view name = scheme == Scheme::Https ? "https://" : "http://";
    const std::string_view rest = text.substr(name.size());
    const std::string_view authority = rest.substr(0, rest.find_first_of("/?#"));
    if (authority.find('@') != authority.npos)
        return refused(
            url.shown_,
            "a URL with a name and password in it would show them to everybody who lists processes; give "
            "a presigned URL, or s3:// with credentials in the environment");
    const auto isHost = [](char c) { return isPlain(c) || c == ':' || c == '[' || c == ']'; };
    if (authority.empty() || authority.front() == ':' || !std::ranges::all_of(authority, isHost))
        return refused(url.shown_, "names no host");
    if (text.find('#') != text.npos) return refused(url.shown_, "a URL of a file has no #; write it as %23");
    const auto outside = [](char c) {
        return static_cast<unsigned char>(c) <= 0x20 || static_cast<unsigned char>(c) >= 0x7f || c == '"' ||
               c == '<' || c == '>' || c == '\\' || c == '^' || c == '`' || c == '{' || c == '|' || c == '}';
    };
    if (std::ranges::any_of(text, outside))
        return refused(url.shown_, "has characters that no URL has; write them as %XX");
    const std::string_view behind = rest.substr(authority.size());
    const std::string_view path = behind.substr(0, behind.find('?'));
    if (path.size() < 2 || path.ends_with('/')) return refused(url.shown_, "names no file");
    const std::string_view query = behind.substr(path.size());
    std::string host(authority);
    std::ranges::transform(host, host.begin(), lowered);
    url.whole_ = std::string(name) + host + std::string(behind);
    url.shown_ = std::string(name) + host + std::string(path);
    url.identity_ = isSigned(query) ? url.shown_ : url.whole_;
    url.name_ = percentDecoded(lastComponent(path));
    return url;
}

std::string RemoteUrl::folderName() const {
    const std::size_t host = shown_.find('/', shown_.find("://") + 3), end = shown_.rfind('/');
    if (host == shown_.npos || end == host) return {};
    const std::string name = lastComponent(std::string_view(shown_).substr(0, end));
    return scheme_ == Scheme::S3 ? name : percentDecoded(name);
}

bool RemoteUrl::isPresigned() const {
    return scheme_ != Scheme::S3 && isSigned(std::string_view(whole_).substr(shown_.size()));
}

Expected<RemoteUrl> RemoteUrl::beside(std::string_view name) const {
    const auto isOfNames = [](char c) { return (isPlain(c) && c != '~') || c == '/'; };
    if (name.empty() || name.front() == '/' || name.find("..") != name.npos ||
        !std::ranges::all_of(name, isOfNames))
        return refused(shown_, "what lies beside it has a name of letters, digits, -._ and slashes");
    return parse(shown_.substr(0, shown_.rfind('/') + 1) + std::string(name) + whole_.substr(shown_.size()));
}

}  // namespace scancast
