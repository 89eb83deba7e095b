// Progress for people, on standard error: one line that redraws itself on a terminal (bar, rate, time left),
// plain lines a few seconds apart in a log. Standard output stays free for data. Owner: a subcommand, for as
// long as it works. Threads: report() from any; everything else from the owner's.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>

#include "renderer/cloud/progress.hpp"

namespace scancast {

class ProgressBar {
  public:
    enum class Style { Automatic, Terminal, Lines, Quiet };

    /// Automatic: a bar when `out` is a terminal, lines otherwise.
    explicit ProgressBar(std::FILE* out = stderr, Style style = Style::Automatic);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void report(const Progress& progress);
    /// report() as a function to hand on; valid as long as this bar is.
    ProgressSink sink();
    /// Takes the bar off the terminal, so that other lines can be printed. The next report draws it again.
    void clear();

  private:
    using Clock = std::chrono::steady_clock;

    void beginStage(const Progress& progress, Clock::time_point now);
    void drawBar(const Progress& progress, double seconds);
    void printLine(const Progress& progress, double seconds);

    std::FILE* out_;
    Style style_;
    std::mutex mutex_;
    std::string stage_;
    Clock::time_point stageStart_{};
    Clock::time_point lastPrint_{};
    std::uint64_t stageFirst_ = 0;  ///< what was already done when the stage began
    bool stageEnded_ = false;
    bool drawn_ = false;
};

/// "950", "12.5 k", "20.0 M", "1.25 G": three digits and a decimal prefix.
std::string shortCount(double value);
/// "42 s", "3:07 min", "2:05 h".
std::string shortDuration(double seconds);
/// "[=====>    ]  52 %  generating 10.4 M of 20.0 M points  4.10 M/s  2 s left" - what the bar shows.
std::string progressText(const Progress& progress, double secondsInStage, std::uint64_t firstDone,
                         int barWidth);

}  // namespace scancast
