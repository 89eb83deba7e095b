// A body that is made while it is sent: part after part, each asked for when the one before is on its way. Nobody knows how long
// it will be; who reads sees by the last chunk that it was all.
//
// Owned by the answer that it belongs to. Place: api → **body source** → http connection.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "protocol/error.hpp"
#include "server/base/transient_memory.hpp"

namespace scancast {

struct BodyPart {
    std::vector<std::byte> bytes;
    bool last = false;  ///< nothing follows but the trailers
    std::vector<std::pair<std::string, std::string>> trailers{};
    TransientMemory::Hold hold{};  ///< of the bytes
};

class BodySource {
  public:
    using Given = std::function<void(Expected<std::shared_ptr<const BodyPart>>)>;

    virtual ~BodySource() = default;
    /// Calls `given` with the next part, once, from any thread; never, where nobody waits any more. One part at a time is
    /// asked for. After an error, and after the last part, there is none.
    virtual void next(Given given) = 0;
};

}  // namespace scancast
