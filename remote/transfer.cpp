#include "remote/transfer.hpp"

#include <fmt/format.h>

#include <string_view>

namespace scancast {
namespace {

constexpr std::size_t longestErrorBody = 4096;
constexpr long mostRedirects = 5;
// Whose time a whole object has at most: nobody knows how long it is.
constexpr std::uint64_t documentBytes = 400 << 10, objectBytes = 16 << 20;

bool isSecure(const std::string& url) {
    return url.starts_with("https://");
}

/// The library's own words, which name neither hosts nor queries.
RequestFault faultOfCurl(CURLcode code) {
    switch (code) {
        case CURLE_TOO_MANY_REDIRECTS:
            return {RequestFault::Kind::Refused, "it redirects without an end"};
        case CURLE_UNSUPPORTED_PROTOCOL:
            return {RequestFault::Kind::Refused,
                    "it redirects to where no file is fetched from (https leads to https only)"};
        case CURLE_PEER_FAILED_VERIFICATION:
            return {RequestFault::Kind::Refused,
                    "its certificate is not one that this machine trusts (SSL_CERT_FILE names other "
                    "authorities)"};
        case CURLE_SSL_CACERT_BADFILE:
            return {RequestFault::Kind::Refused, "the file of certificates to trust cannot be read"};
        case CURLE_OPERATION_TIMEDOUT:
            return {RequestFault::Kind::Unreachable, "it did not answer in time"};
        default:
            return {RequestFault::Kind::Unreachable, curl_easy_strerror(code)};
    }
}

}  // namespace

bool Transfer::begin(Handle handle, const TransferLimits& limits) {
    handle_ = std::move(handle);
    head_ = {};
    bytes_.clear();
    errorBody_.clear();
    fault_.reset();
    CURL* const curl = handle_.get();
    const ObjectAccess& access = *ask_.access;
    bool sound = true;
    const auto set = [&](CURLoption option, auto value) {
        sound = sound && curl_easy_setopt(curl, option, value) == CURLE_OK;
    };
    curl_easy_reset(curl);
    headers_.reset();
    const auto addHeader = [&](const std::string& line) {
        if (curl_slist* longer = curl_slist_append(headers_.get(), line.c_str())) {
            (void)headers_.release();
            headers_.reset(longer);
        } else {
            sound = false;
        }
    };
    for (const std::string& header : access.headers) addHeader(header);
    addHeader("Accept-Encoding: identity");
    if (ask_.expected)
        if (const std::string tag = ask_.expected->strongTag(); !tag.empty()) addHeader("If-Match: " + tag);
    if (!ask_.unless.empty()) addHeader("If-None-Match: " + ask_.unless);
    const std::string range = fmt::format("{}-{}", ask_.first, ask_.first + ask_.bytes - 1);
    set(CURLOPT_URL, access.url.c_str());
    if (!ask_.whole) set(CURLOPT_RANGE, range.c_str());
    set(CURLOPT_HTTPHEADER, headers_.get());
    set(CURLOPT_USERAGENT, "scancast");
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_QUICK_EXIT, 1L);                // nobody waits for a name that is still being looked up
    set(CURLOPT_SUPPRESS_CONNECT_HEADERS, 1L);  // what a proxy says is not the object's head
    set(CURLOPT_PATH_AS_IS, 1L);                // an object's key may have "..", and is signed as it is
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_REDIR_PROTOCOLS_STR, isSecure(access.url) ? "https" : "http,https");
    set(CURLOPT_FOLLOWLOCATION, access.mayRedirect ? 1L : 0L);
    set(CURLOPT_MAXREDIRS, mostRedirects);
    set(CURLOPT_HTTP_VERSION, long(CURL_HTTP_VERSION_2TLS));
    set(CURLOPT_PIPEWAIT, isSecure(access.url) ? 1L : 0L);
    set(CURLOPT_BUFFERSIZE, 128L << 10);
    set(CURLOPT_TCP_KEEPALIVE, 1L);
    set(CURLOPT_CONNECTTIMEOUT_MS, long(limits.connect.count()));
    set(CURLOPT_LOW_SPEED_LIMIT, limits.leastRate);
    set(CURLOPT_LOW_SPEED_TIME, std::max(1L, long(limits.stall.count() / 1000)));
    const std::uint64_t bytes =
        ask_.whole ? std::min(ask_.bytes, ask_.isDocument ? documentBytes : objectBytes) : ask_.bytes;
    set(CURLOPT_TIMEOUT_MS, long(limits.grace.count()) + long(bytes * 1000 / std::uint64_t(limits.slowest)));
    if (!access.certificates.empty()) set(CURLOPT_CAINFO, access.certificates.c_str());
    if (!access.signing.empty()) {
        set(CURLOPT_AWS_SIGV4, access.signing.c_str());
        set(CURLOPT_USERNAME, access.user.c_str());
        set(CURLOPT_PASSWORD, access.password.c_str());
    }
    set(CURLOPT_HEADERFUNCTION, &Transfer::onHeader);
    set(CURLOPT_HEADERDATA, static_cast<void*>(this));
    set(CURLOPT_WRITEFUNCTION, &Transfer::onBody);
    set(CURLOPT_WRITEDATA, static_cast<void*>(this));
    set(CURLOPT_PRIVATE, static_cast<void*>(this));
    return sound;
}

// Exceptions must not go through a library in C: where memory runs out, the transfer is aborted.
std::size_t Transfer::onHeader(char* data, std::size_t size, std::size_t count, void* self) {
    try {
        static_cast<Transfer*>(self)->head_.add({data, size * count});
        return size * count;
    } catch (...) {
        return 0;
    }
}

std::size_t Transfer::onBody(char* data, std::size_t size, std::size_t count, void* self) {
    try {
        return static_cast<Transfer*>(self)->takeBody({data, size * count}) ? size * count : 0;
    } catch (...) {
        return 0;
    }
}

bool Transfer::takeBody(std::string_view data) {
    if (head_.status >= 400) {
        errorBody_.append(data.substr(0, longestErrorBody - errorBody_.size()));
        return errorBody_.size() < longestErrorBody;
    }
    if (head_.status >= 300) return true;  // of a redirection, which curl bounds by time
    if (bytes_.empty()) {
        const auto state = judged();
        if (!state) {
            fault_ = state.error();
            return false;
        }
    }
    if (data.size() > ask_.bytes - bytes_.size()) {
        fault_ = RequestFault{RequestFault::Kind::Unsuitable,
                              ask_.whole ? fmt::format("it is longer than {} bytes", ask_.bytes)
                                         : "its server sends more than was asked for"};
        return false;
    }
    if (bytes_.empty() && !ask_.whole) bytes_.reserve(ask_.bytes);
    const auto* const from = reinterpret_cast<const std::byte*>(data.data());
    bytes_.insert(bytes_.end(), from, from + data.size());
    return true;
}

tl::expected<ObjectState, RequestFault> Transfer::judged(std::string_view body) const {
    return ask_.whole ? judgeWhole(head_, body)
                      : judge(head_, ask_.first, ask_.bytes, ask_.expected ? &*ask_.expected : nullptr, body);
}

PartOrFault Transfer::end(CURLcode result) {
    if (fault_) return tl::unexpected(std::move(*fault_));
    const bool isError = head_.status >= 400;
    if (result != CURLE_OK && !isError) return tl::unexpected(faultOfCurl(result));
    if (ask_.whole && head_.status == 304 && !ask_.unless.empty())
        return Part{{0, ask_.unless, {}}, {}, true};
    auto state = judged(errorBody_);
    if (!state) return tl::unexpected(std::move(state.error()));
    if (ask_.whole) {
        state->bytes = bytes_.size();
        return Part{std::move(*state), std::move(bytes_)};
    }
    if (bytes_.size() != std::min(ask_.bytes, state->bytes - ask_.first))
        return tl::unexpected(RequestFault{RequestFault::Kind::Unreachable, "its answer ended too early"});
    return Part{std::move(*state), std::move(bytes_)};
}

}  // namespace scancast
