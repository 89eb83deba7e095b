#include "server/base/event_writer.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/text/plain_text.hpp"

namespace scancast {
namespace {

using WallClock = std::chrono::system_clock;

// What a pipe takes as a whole or not at all (PIPE_BUF), once it says that it takes something.
constexpr std::size_t longestLine = 4096;

const char* name(LogLevel level) {
    return level == LogLevel::Debug ? "debug" : "info";
}

std::string textLine(LogLevel level, const std::string& sentence) {
    std::tm local{};
    const std::time_t now = WallClock::to_time_t(WallClock::now());
    localtime_r(&now, &local);
    std::string line = fmt::format("{:%H:%M:%S} {}: {}", local, name(level), plainLine(sentence));
    if (line.size() >= longestLine) line = plainLine(line.substr(0, longestLine - 8)) + "...";
    return line;
}

std::string jsonLine(LogLevel level, const std::string& sentence, nlohmann::json fields) {
    const auto now = WallClock::now();
    const auto whole = std::chrono::floor<std::chrono::seconds>(now);
    std::tm utc{};
    const std::time_t seconds = WallClock::to_time_t(whole);
    gmtime_r(&seconds, &utc);
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - whole).count();
    const std::string time = fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", utc, ms);
    fields["time"] = time;
    fields["level"] = name(level);
    fields["message"] = sentence;
    std::string line = printJson(fields);
    if (line.size() < longestLine) return line;
    // Still an object: a line that is cut is none.
    return printJson(
        {{"time", time}, {"level", name(level)}, {"message", plainLine(sentence.substr(0, 512))}});
}

}  // namespace

Expected<std::shared_ptr<EventWriter>> EventWriter::create(const std::string& level,
                                                           const std::string& format, int descriptor) {
    LogLevel least = LogLevel::Above;
    if (level == "debug") {
        least = LogLevel::Debug;
    } else if (level == "info") {
        least = LogLevel::Info;
    } else if (level != "warn" && level != "error" && level != "off") {
        return fail(ErrorCode::InvalidArgument,
                    "--log-level " + level + ": it is debug, info, warn, error or off.", "log-level");
    }
    if (format != "text" && format != "json") {
        return fail(ErrorCode::InvalidArgument, "--log-format " + format + ": it is text or json.",
                    "log-format");
    }
    return std::shared_ptr<EventWriter>(
        new EventWriter(least, format == "json" ? Format::Json : Format::Text, descriptor));
}

bool EventWriter::write(LogLevel level, const std::string& sentence, nlohmann::json fields) {
    if (!writes(level)) return true;
    std::string line =
        format_ == Format::Json ? jsonLine(level, sentence, std::move(fields)) : textLine(level, sentence);
    line += '\n';
    const std::lock_guard lock(mutex_);
    pollfd reader{descriptor_, POLLOUT, 0};
    if (::poll(&reader, 1, 0) != 1 || (reader.revents & POLLOUT) == 0) return false;
    ssize_t written = 0;
    do {
        written = ::write(descriptor_, line.data(), line.size());
    } while (written < 0 && errno == EINTR);
    return written == ssize_t(line.size());
}

}  // namespace scancast
