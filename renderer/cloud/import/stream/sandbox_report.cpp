#include "renderer/cloud/import/stream/sandbox_report.hpp"

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/importer_launch.hpp"

namespace scancast {

namespace {

constexpr std::size_t longestReport = 4096;
constexpr std::chrono::seconds patience{20};

}  // namespace

Expected<SandboxReport> askSandbox(const ImportOptions& options) {
    const auto launcher = findSandbox(options);
    if (!launcher) return passOn(launcher);
    auto launched = launch({launcher->string(), "--report"}, -1);
    if (!launched) return passOn(launched);
    ImporterProcess process(std::move(*launched), patience);
    std::string text(longestReport, '\0');
    const auto got = readFully(process, std::as_writable_bytes(std::span(text)));
    if (!got) return fail(ErrorCode::Importer, launcher->string() + ": " + got.error().message);
    text.resize(*got);
    while (text.ends_with('\n')) text.pop_back();
    const auto end = process.badEnd();
    if (text.empty())
        return fail(ErrorCode::Importer, launcher->string() + " " + end.value_or("said nothing"));
    return SandboxReport{!end, printableText(text, longestReport)};
}

}  // namespace scancast
