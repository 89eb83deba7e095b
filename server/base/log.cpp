#include "server/base/log.hpp"

#include <spdlog/formatter.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/json_text.hpp"
#include "protocol/text/plain_text.hpp"

namespace scancast {
namespace {

std::string utc(spdlog::log_clock::time_point time) {
    const std::time_t seconds = spdlog::log_clock::to_time_t(time);
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

// A pattern cannot escape quotes and line ends; this can.
class JsonFormatter final : public spdlog::formatter {
  public:
    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
        const auto level = spdlog::level::to_string_view(message.level);
        const std::string line =
            printJson({{"time", utc(message.time)},
                       {"level", std::string(level.data(), level.size())},
                       {"message", std::string(message.payload.data(), message.payload.size())}});
        out.append(line.data(), line.data() + line.size());
        out.push_back('\n');
    }
    std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

// A file's name, or what an importer says, must not write a line of its own.
class LineFormatter final : public spdlog::formatter {
  public:
    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
        const std::string line = plainLine({message.payload.data(), message.payload.size()});
        spdlog::details::log_msg plain = message;
        plain.payload = line;
        pattern_.format(plain, out);
    }
    std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<LineFormatter>(); }

  private:
    spdlog::pattern_formatter pattern_{"%H:%M:%S %l: %v"};
};

}  // namespace

Expected<void> setUpLog(const std::string& level, const std::string& format) {
    const auto known = spdlog::level::from_str(level);
    if (known == spdlog::level::off && level != "off") {
        return fail(ErrorCode::InvalidArgument,
                    "--log-level " + level + ": it is debug, info, warn, error or off.", "log-level");
    }
    auto logger =
        std::make_shared<spdlog::logger>("scancast", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    if (format == "json") {
        logger->set_formatter(std::make_unique<JsonFormatter>());
    } else if (format == "text") {
        logger->set_formatter(std::make_unique<LineFormatter>());
    } else {
        return fail(ErrorCode::InvalidArgument, "--log-format " + format + ": it is text or json.",
                    "log-format");
    }
    logger->set_level(known);
    spdlog::set_default_logger(std::move(logger));
    return {};
}

}  // namespace scancast
