// Answers what is measured from the scan's points: volumes, and shapes that are fitted. That may take seconds, so it has a thread of its
// own: neither network threads nor somebody's pick wait for it. What vertices tell by themselves is answered at once.
//
// Owned by the API. *Thread safety*: any thread. Pipeline: api → **measurer** → renderer/measure.
#pragma once

#include <memory>
#include <stop_token>

#include "renderer/cloud/cloud.hpp"
#include "server/base/transient_memory.hpp"
#include "server/net/api/http_message.hpp"
#include "server/net/api/router.hpp"
#include "server/net/worker.hpp"
#include "server/price/admission.hpp"

namespace scancast {

class Measurer {
  public:
    /// The admission outlives this.
    Measurer(const Admission& admission, TransientMemory memory, std::uint64_t maxPixels);

    /// Answers a POST that measures this cloud, at once or when it is done; never once `gone` is requested, which ends the work, too.
    /// Its memory is counted with that of answers, its work with that of pictures. Problems: 400; 413 (more points than one
    /// answer may take work for); 422 (no lengths; nothing is there); 429 and 503 where too much waits; 500 where the cloud is damaged.
    void answer(const HttpRequest& request, const Routed& routed, const std::shared_ptr<const Cloud>& cloud,
                Respond respond, std::stop_token gone) const;
    /// Nothing is answered afterwards.
    void stop() { worker_.stop(); }

  private:
    struct Asked;
    void measure(const Asked& asked, const std::stop_token& stop) const;

    const Admission& admission_;
    const TransientMemory memory_;
    const std::uint64_t maxPixels_;
    mutable Worker worker_;  // last: ends before the rest
};

}  // namespace scancast
