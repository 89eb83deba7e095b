#include "server/terminal/progress_bar.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace scancast {
namespace {

constexpr std::chrono::milliseconds redrawEvery{100};
constexpr std::chrono::seconds lineEvery{5};

template <class... Values>
std::string format(const char* pattern, Values... values) {
    char text[96];
    std::snprintf(text, sizeof text, pattern, values...);
    return text;
}

int terminalColumns(std::FILE* out) {
    winsize size{};
    if (ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return 80;
}

}  // namespace

std::string shortCount(double value) {
    static constexpr const char* suffixes[] = {"", " k", " M", " G", " T"};
    int power = 0;
    // 999.95 would print as "1000" with three digits, hence not a plain 1000.
    for (; value >= 999.5 && power < 4; ++power) value /= 1000;
    if (power == 0) return format("%.0f", value);
    const int decimals = value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
    return format("%.*f%s", decimals, value, suffixes[power]);
}

std::string shortDuration(double seconds) {
    const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
    if (whole < 60) return format("%lld s", whole);
    if (whole < 3600) return format("%lld:%02lld min", whole / 60, whole % 60);
    return format("%lld:%02lld h", whole / 3600, whole / 60 % 60);
}

std::string progressText(const Progress& progress, double secondsInStage, std::uint64_t firstDone,
                         int barWidth) {
    std::string text;
    const bool totalKnown = progress.total > 0;
    const double part = totalKnown ? std::min(1.0, double(progress.done) / double(progress.total)) : 0.0;
    if (totalKnown && barWidth > 0) {
        const int filled = static_cast<int>(part * barWidth);
        text += '[' + std::string(std::size_t(filled), '=');
        if (filled < barWidth) text += '>' + std::string(std::size_t(barWidth - filled - 1), ' ');
        text += "] ";
    }
    if (totalKnown) text += format("%3d %%  ", static_cast<int>(part * 100));
    text += std::string(progress.stage) + ' ' + shortCount(double(progress.done));
    if (totalKnown) text += " of " + shortCount(double(progress.total));
    if (!progress.unit.empty()) text += ' ' + std::string(progress.unit);
    if (secondsInStage < 0.2 || progress.done <= firstDone) return text;
    const double rate = double(progress.done - firstDone) / secondsInStage;
    text += "  " + shortCount(rate) + "/s";
    if (totalKnown && progress.done < progress.total)
        text += "  " + shortDuration(double(progress.total - progress.done) / rate) + " left";
    return text;
}

ProgressBar::ProgressBar(std::FILE* out, Style style) : out_(out), style_(style) {
    if (style_ == Style::Automatic) style_ = isatty(fileno(out)) ? Style::Terminal : Style::Lines;
}

ProgressBar::~ProgressBar() {
    clear();
}

ProgressSink ProgressBar::sink() {
    return [this](const Progress& progress) { report(progress); };
}

void ProgressBar::clear() {
    const std::lock_guard lock(mutex_);
    if (!drawn_) return;
    std::fputs("\r\033[K", out_);
    std::fflush(out_);
    drawn_ = false;
}

void ProgressBar::beginStage(const Progress& progress, Clock::time_point now) {
    stage_ = progress.stage;
    stageStart_ = now;
    stageFirst_ = progress.done;
    stageEnded_ = false;
    // A terminal answers at once; a log only hears of work that takes long enough to matter.
    lastPrint_ = style_ == Style::Terminal ? now - redrawEvery : now;
}

void ProgressBar::report(const Progress& progress) {
    if (style_ == Style::Quiet) return;
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    if (stage_ != progress.stage || stageStart_ == Clock::time_point{}) beginStage(progress, now);
    const bool ends = progress.total > 0 && progress.done >= progress.total;
    if (stageEnded_ && ends) return;
    stageEnded_ = ends;
    const auto since = now - lastPrint_;
    const double seconds = std::chrono::duration<double>(now - stageStart_).count();
    if (style_ == Style::Terminal) {
        if (since < redrawEvery && !ends) return;
        drawBar(progress, seconds);
    } else {
        if (since < lineEvery && !ends) return;
        printLine(progress, seconds);
    }
    lastPrint_ = now;
}

void ProgressBar::drawBar(const Progress& progress, double seconds) {
    const int columns = terminalColumns(out_);
    const int barWidth = std::clamp(columns - 70, 0, 40);
    std::string text = progressText(progress, seconds, stageFirst_, barWidth);
    // A line longer than the terminal would wrap and could not be taken back.
    if (text.size() >= std::size_t(columns)) text.resize(std::size_t(columns) - 1);
    std::fprintf(out_, "\r\033[K%s", text.c_str());
    std::fflush(out_);
    drawn_ = true;
}

void ProgressBar::printLine(const Progress& progress, double seconds) {
    std::fprintf(out_, "%s\n", progressText(progress, seconds, stageFirst_, 0).c_str());
    std::fflush(out_);
}

}  // namespace scancast
