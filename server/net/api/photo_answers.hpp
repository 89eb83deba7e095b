// Answers with the photos that clouds' scans brought along: their bytes as they are, never decoded. Reading them is work for a
// thread of its own, as picking is: a photo may have 128 MiB and lie on a slow disk, and neither a network thread nor somebody's
// pick should wait for that.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api → **photo answers** → photo bytes (renderer/cloud/stations).
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "renderer/cloud/cloud.hpp"
#include "server/base/transient_memory.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"
#include "server/net/worker.hpp"
#include "server/price/admission.hpp"

namespace scancast {

/// The photo of that number, as it stands in an address: from 0, without anything before or behind it. 404 for all else.
tl::expected<const Photo*, Problem> photoOfNumber(const Cloud& cloud, std::string_view number);

class PhotoAnswers {
  public:
    /// The admission outlives this.
    PhotoAnswers(const Admission& admission, TransientMemory memory);

    /// Answers a GET or a HEAD of a photo of this cloud, at once or when it has been read; never once `gone` is requested.
    /// Its bytes are counted as unread pictures are, from before they are read until they have been sent. Problems: 404; 406;
    /// 429 and 503 where too much is unread; 503 where too much waits; 500 where the photo cannot be read.
    void answer(const HttpRequest& request, const Routed& routed, const std::shared_ptr<const Cloud>& cloud,
                Respond respond, std::stop_token gone) const;
    /// Nothing is answered afterwards.
    void stop() { worker_.stop(); }

  private:
    struct Asked;

    void read(const Asked& asked) const;
    std::optional<std::string> knownTag(const std::shared_ptr<const PhotoBytes>& data) const;
    void keepTag(const std::shared_ptr<const PhotoBytes>& data, const std::string& tag) const;

    const Admission& admission_;
    const TransientMemory memory_;
    struct Tag {
        std::weak_ptr<const PhotoBytes> of;
        std::string text;
    };

    mutable std::mutex mutex_;
    /// Of the photos that have been read, as long as their clouds live: who has one is told so without reading it again.
    mutable std::map<const PhotoBytes*, Tag> tags_;
    mutable Worker worker_;  // last: ends before the rest
};

}  // namespace scancast
