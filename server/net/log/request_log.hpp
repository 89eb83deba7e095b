// The request log: one line for each request, two for a stream, in the server's log. Probes that are answered as
// they should be are said at level debug alone. Lines that repeat are counted (repeats.hpp), and so are those that were
// lost because nobody read the log.
//
// Owned by the server, which outlives every connection. *Thread safety*: every function may be called from any
// thread; never waits for a disk. Pipeline: connections → **request log** → event writer.
#pragma once

#include <memory>
#include <mutex>

#include "server/base/event_writer.hpp"
#include "server/base/metrics.hpp"
#include "server/net/log/repeats.hpp"
#include "server/net/log/request_record.hpp"

namespace scancast {

struct RequestLogOptions {
    std::shared_ptr<EventWriter> writer;                   ///< empty = there is no request log
    std::optional<RepeatLimits> repeats = RepeatLimits{};  ///< empty = every line is written
};

class RequestLog {
  public:
    using Clock = RequestRecord::Clock;
    class Request;

    RequestLog(const RequestLogOptions& options, Metrics& metrics);
    /// Says what is still to be said of repeats.
    ~RequestLog();
    RequestLog(const RequestLog&) = delete;
    RequestLog& operator=(const RequestLog&) = delete;

    /// A request has been read; it is in flight from now on.
    Request begin(RequestRecord record);
    /// A request, or a stream at one of its ends, as it is to be told. A record that cannot be written changes nothing for its
    /// connection.
    void add(const RequestRecord& record, Clock::time_point now = Clock::now()) noexcept;
    /// Now and then: says how often what was left out has been repeated.
    void passTime(Clock::time_point now) noexcept;

  private:
    void tell(const std::vector<Repeated>& repeated);
    void write(LogLevel level, const std::string& sentence, nlohmann::json fields);

    const RequestLogOptions options_;
    Metrics& metrics_;
    std::mutex mutex_;  // guards what follows
    Repeats repeats_;
    std::uint64_t lost_ = 0;  // and not told yet
};

/// A request in flight, of one connection. It is logged once, whatever becomes of it: where nobody says how it was
/// answered, its client has left.
class RequestLog::Request {
  public:
    Request() = default;  ///< none
    Request(Request&& other) noexcept;
    Request& operator=(Request&& other) noexcept;
    ~Request();

    explicit operator bool() const { return log_ != nullptr; }
    /// What is known by now; of none it is of no use.
    RequestRecord& record() { return record_; }
    /// It is over; nothing where there is none.
    void answered(std::uint64_t bytes) noexcept;
    /// The same, of one whose client did not get all of it.
    void left(std::uint64_t bytes, std::string_view why) noexcept;
    /// It becomes a stream, which tells of itself.
    RequestRecord handOver();

  private:
    friend class RequestLog;
    Request(RequestLog& log, RequestRecord record);
    void end(std::uint64_t bytes) noexcept;

    RequestLog* log_ = nullptr;
    RequestRecord record_;
};

}  // namespace scancast
