#include "server/net/log/request_log.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "server/base/faults.hpp"
#include "server/net/api/router.hpp"

namespace scancast {
namespace {

/// Asked every few seconds by whoever watches the server, and of interest when they are not answered well.
bool isAnsweredProbe(const RequestRecord& record) {
    constexpr int firstFailure = 400;
    return record.status < firstFailure &&
           (record.route == pattern(Route::Health) || record.route == pattern(Route::Ready) ||
            record.route == pattern(Route::Metrics));
}

std::string sentenceOf(const Repeated& repeated, std::chrono::seconds window) {
    const auto& [client, status, route] = repeated.kind;
    std::string text = fmt::format("{} more requests", repeated.times);
    if (!client.empty()) text += " for " + client;
    if (status != 0) text += fmt::format(" that were answered {} ({})", status, route);
    return text + fmt::format(" within {} s, which are not listed", window.count());
}

nlohmann::json fieldsOf(const Repeated& repeated, std::chrono::seconds window) {
    nlohmann::json json{{"event", "repeated"}, {"times", repeated.times}, {"seconds", window.count()}};
    if (!repeated.kind.client.empty()) json["client"] = repeated.kind.client;
    if (repeated.kind.status != 0) {
        json["status"] = repeated.kind.status;
        json["route"] = repeated.kind.route;
    }
    return json;
}

}  // namespace

RequestLog::RequestLog(const RequestLogOptions& options, Metrics& metrics)
    : options_(options), metrics_(metrics), repeats_(options.repeats) {}

RequestLog::~RequestLog() {
    std::ignore = contained("The request log", [this] {
        const std::lock_guard lock(mutex_);
        tell(repeats_.finish());
    });
}

void RequestLog::add(const RequestRecord& record, Clock::time_point now) noexcept {
    const LogLevel level = isAnsweredProbe(record) ? LogLevel::Debug : LogLevel::Info;
    if (!options_.writer || !options_.writer->writes(level)) return;
    std::ignore = contained("The request log", [&] {
        const std::lock_guard lock(mutex_);
        tell(repeats_.passTime(now));
        if (repeats_.admit(record.client, record.status, record.route, now))
            write(level, record.sentence(now), record.fields(now));
        else
            metrics_.logLine(LogLine::Repeated);
    });
}

RequestLog::Request RequestLog::begin(RequestRecord record) {
    return {*this, std::move(record)};
}

RequestLog::Request::Request(RequestLog& log, RequestRecord record) : log_(&log), record_(std::move(record)) {
    log_->metrics_.requestBegan();
}

RequestLog::Request::Request(Request&& other) noexcept
    : log_(std::exchange(other.log_, nullptr)), record_(std::move(other.record_)) {}

RequestLog::Request& RequestLog::Request::operator=(Request&& other) noexcept {
    left(0, "left");
    log_ = std::exchange(other.log_, nullptr);
    record_ = std::move(other.record_);
    return *this;
}

RequestLog::Request::~Request() {
    left(0, "left");
}

void RequestLog::Request::answered(std::uint64_t bytes) noexcept {
    end(bytes);
}

void RequestLog::Request::left(std::uint64_t bytes, std::string_view why) noexcept {
    if (log_ == nullptr) return;
    record_.status = statusClientLeft;
    if (record_.note.empty()) std::ignore = contained("The request log", [&] { record_.note = why; });
    end(bytes);
}

RequestRecord RequestLog::Request::handOver() {
    if (log_ != nullptr) std::exchange(log_, nullptr)->metrics_.requestEnded();
    return std::move(record_);
}

void RequestLog::Request::end(std::uint64_t bytes) noexcept {
    if (log_ == nullptr) return;
    record_.bytes = bytes;
    RequestLog& log = *std::exchange(log_, nullptr);
    log.metrics_.requestEnded();
    log.add(record_);
}

void RequestLog::passTime(Clock::time_point now) noexcept {
    if (!options_.writer) return;
    std::ignore = contained("The request log", [&] {
        const std::lock_guard lock(mutex_);
        tell(repeats_.passTime(now));
    });
}

void RequestLog::tell(const std::vector<Repeated>& repeated) {
    if (!options_.writer || !options_.repeats) return;
    const auto window = options_.repeats->window;
    for (const Repeated& one : repeated)
        write(LogLevel::Info, sentenceOf(one, window), fieldsOf(one, window));
}

void RequestLog::write(LogLevel level, const std::string& sentence, nlohmann::json fields) {
    if (lost_ > 0 &&
        options_.writer->write(LogLevel::Info,
                               fmt::format("{} lines of the request log were lost: nobody read it", lost_),
                               {{"event", "lost"}, {"times", lost_}}))
        lost_ = 0;
    const bool written = options_.writer->write(level, sentence, std::move(fields));
    if (!written) ++lost_;
    metrics_.logLine(written ? LogLine::Written : LogLine::Lost);
}

}  // namespace scancast
