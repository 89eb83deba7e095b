// What a server answers to a request for a part of an object, and whether that can be believed: it has to be that part, of the
// object that was opened, as it is. Nothing of it is: other lengths, other places, all of it, compressed. Pure functions; any
// thread. Place: requests → **answers** → pieces.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/error.hpp"

namespace scancast {

struct ContentRange {
    std::uint64_t first = 0, last = 0, total = 0;
    bool operator==(const ContentRange&) const = default;
};
/// "bytes 0-99/1234". nullopt for everything else, a size of `*` and ends before beginnings included.
std::optional<ContentRange> parseContentRange(std::string_view text);

/// The `Code` of an error of S3: "NoSuchKey"; empty where there is none. `body` may be cut off anywhere.
std::string s3ErrorCode(std::string_view body);

/// Which object it is, in which state.
struct ObjectState {
    std::uint64_t bytes = 0;
    std::string etag, lastModified;  ///< as they were sent; empty = were not
    bool operator==(const ObjectState&) const = default;
    /// It would be noticed if it changed: what was read of it may be kept.
    bool isKnown() const { return !etag.empty() || !lastModified.empty(); }
    /// What If-Match takes; empty for none, and for a weak one.
    std::string strongTag() const;
};

/// The headers that matter of one answer. What is too long to be sound counts as not sent.
struct AnswerHead {
    long status = 0;
    std::string contentRange, contentEncoding, etag, lastModified, retryAfter;

    /// One line of the head as it came; the first one of an answer - after a redirect - begins anew.
    void add(std::string_view line);
};

/// Why there are no bytes.
struct RequestFault {
    enum class Kind : std::uint8_t {
        Unreachable,  ///< nothing or half an answer came, or the server is not able to give one: worth another try
        Refused,     ///< it answers, and will the next time: 403, 404 …
        Unsuitable,  ///< it does not do what is needed: no ranges, compressed, wrong ones
        Changed,     ///< it is another object now
        Stopped,     ///< by us
    };
    Kind kind = Kind::Unreachable;
    std::string text;                             ///< half a sentence, without a URL: "it answered 503"
    std::optional<std::chrono::seconds> after{};  ///< when the server wants to be asked again

    /// The server is there, and the object is not: 404, 410.
    bool isMissing() const;
};

/// The state of the object where the answer brings `bytes` bytes from `first` on, or as many as there are; `expected` is the
/// state that it has to have (nullptr = any). `body`: of an error, its beginning.
tl::expected<ObjectState, RequestFault> judge(const AnswerHead& head, std::uint64_t first,
                                              std::uint64_t bytes, const ObjectState* expected,
                                              std::string_view body = {});

/// The same of an answer that brings all there is: its size is not known until it has ended.
tl::expected<ObjectState, RequestFault> judgeWhole(const AnswerHead& head, std::string_view body = {});

}  // namespace scancast
