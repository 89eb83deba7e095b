// A log that is read back: a file in memory, and an event writer that writes to it.
#pragma once

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "server/base/event_writer.hpp"

namespace scancast::test {

class LogFile {
  public:
    LogFile() : descriptor_(::memfd_create("log", MFD_CLOEXEC)) { EXPECT_GE(descriptor_, 0); }
    ~LogFile() { ::close(descriptor_); }
    LogFile(const LogFile&) = delete;
    LogFile& operator=(const LogFile&) = delete;

    std::shared_ptr<EventWriter> writer(const std::string& level = "info",
                                        const std::string& format = "json") {
        return *EventWriter::create(level, format, descriptor_);
    }
    std::string text() const {
        std::string all;
        std::array<char, 4096> piece{};
        for (ssize_t n = 0; (n = ::pread(descriptor_, piece.data(), piece.size(), off_t(all.size()))) > 0;)
            all.append(piece.data(), std::size_t(n));
        return all;
    }
    /// Of a log in JSON.
    std::vector<nlohmann::json> events() const {
        std::vector<nlohmann::json> events;
        std::istringstream lines(text());
        for (std::string line; std::getline(lines, line);) events.push_back(nlohmann::json::parse(line));
        return events;
    }

  private:
    int descriptor_;
};

}  // namespace scancast::test
