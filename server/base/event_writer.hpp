// Lines of the log that have fields: where the log is JSON these are the object's own members, so that machines
// need not take a sentence apart.
//
// Owned by the server. *Thread safety*: every function may be called from any thread. Never waits: where whoever
// reads the log does not, the line is lost and the caller is told so. A log that stands still must not stop a server
// that says something of each request.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "protocol/error.hpp"

namespace scancast {

enum class LogLevel : std::uint8_t { Debug, Info, Above };

class EventWriter {
  public:
    /// What --log-level and --log-format say; errors are those of setUpLog(). `descriptor` stays the caller's.
    static Expected<std::shared_ptr<EventWriter>> create(const std::string& level, const std::string& format,
                                                         int descriptor = 2);

    /// Whether lines of that level are written at all.
    bool writes(LogLevel level) const { return level >= least_; }
    /// One line of at most 4096 bytes, of which a terminal obeys nothing: the sentence or, of JSON, an object of
    /// `fields` with time, level, and the sentence as `message`. False when it is lost.
    bool write(LogLevel level, const std::string& sentence, nlohmann::json fields);

  private:
    enum class Format : std::uint8_t { Text, Json };
    EventWriter(LogLevel least, Format format, int descriptor)
        : least_(least), format_(format), descriptor_(descriptor) {}

    const LogLevel least_;
    const Format format_;
    const int descriptor_;
    std::mutex mutex_;  // one line at a time
};

}  // namespace scancast
