// One request for a part of an object, or for all of something small, as curl makes it: what is sent, what of the answer is kept, and
// what ends it. An answer is read no further than what was asked for, however long the server goes on. Owned by `Transfers`, used on its thread.
// Place: pieces → **transfer** → network.
#pragma once

#include <curl/curl.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "remote/access.hpp"
#include "remote/answers.hpp"

namespace scancast {

/// What is asked for.
struct PartAsk {
    std::shared_ptr<const ObjectAccess> access;
    std::uint64_t first = 0, bytes = 0;     ///< bytes: at least 1
    std::optional<ObjectState> expected{};  ///< that it has to have; an answer of another is a fault
    int tries = 1;                          ///< how often at most, where nothing comes, and soon
    std::chrono::milliseconds delay{0};     ///< before the first one
    /// Not a part: all there is, of `bytes` bytes at most, unless it still has the ETag `unless`.
    bool whole = false;
    bool isDocument = false;  ///< whole, and short: it has the time of a page of 1,000 objects
    std::string unless{};
};

struct Part {
    ObjectState state;
    std::vector<std::byte> bytes;
    bool isUnchanged = false;  ///< it has the ETag that it was asked for unless; without bytes
};
using PartOrFault = tl::expected<Part, RequestFault>;
/// Called once, on the thread of the transfers; must not wait.
using PartDone = std::function<void(PartOrFault)>;

struct TransferLimits {
    std::chrono::milliseconds connect{4000};
    std::chrono::milliseconds stall{5000};  ///< that may pass with less than `leastRate`
    long leastRate = 512;                   ///< bytes a second
    /// Of one request: what brings its bytes more slowly than `slowest` for longer than `grace` is given up.
    std::chrono::milliseconds grace{20000};
    long slowest = 4096;  ///< bytes a second
};

class Transfer {
  public:
    /// An easy handle that may be used again; nullptr where there is no memory.
    using Handle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;

    Transfer(PartAsk ask, PartDone done) : ask_(std::move(ask)), done_(std::move(done)) {}
    Transfer(const Transfer&) = delete;
    Transfer& operator=(const Transfer&) = delete;

    /// Makes the request ready in `handle`, which is this transfer's until takeHandle().
    bool begin(Handle handle, const TransferLimits& limits);
    CURL* handle() const { return handle_.get(); }
    Handle takeHandle() { return std::move(handle_); }
    /// What came of it.
    PartOrFault end(CURLcode result);

    PartAsk& ask() { return ask_; }
    std::uint64_t received() const { return bytes_.size(); }
    void finish(PartOrFault result) { done_(std::move(result)); }

  private:
    static std::size_t onHeader(char* data, std::size_t size, std::size_t count, void* self);
    static std::size_t onBody(char* data, std::size_t size, std::size_t count, void* self);
    bool takeBody(std::string_view data);
    tl::expected<ObjectState, RequestFault> judged(std::string_view body = {}) const;

    PartAsk ask_;
    const PartDone done_;
    Handle handle_{nullptr, &curl_easy_cleanup};
    std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers_{nullptr, &curl_slist_free_all};
    AnswerHead head_;
    std::vector<std::byte> bytes_;
    std::string errorBody_;
    std::optional<RequestFault> fault_;
};

}  // namespace scancast
