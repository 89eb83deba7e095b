// scancast-sandbox: becomes an importer, behind limits and shut in. Started by Scancast, once for each importer; what the shell could not set stands
// here. Decision 18 tells why it is a program of its own.
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "files/system_error.hpp"
#include "importers/sandbox/privileges.hpp"
#include "importers/sandbox/sandbox.hpp"

namespace {

using namespace scancast;

constexpr int scanDescriptor = STDERR_FILENO + 1;
constexpr int usageError = 2, cannotRun = 126, notFound = 127;  // the last two as a shell's

constexpr const char* usage =
    "scancast-sandbox [OPTIONS] PROGRAM [ARGUMENT...]     becomes PROGRAM, shut in; 3 is the scan that it "
    "may read\n"
    "scancast-sandbox --report [--without WHAT]           says what shuts importers in on this machine\n"
    "\n"
    "Scancast starts importers by it. --report ends with 0 where everything holds, else with 1.\n"
    "\n"
    "  --sandbox auto|require|off  what is to be had, all or nothing, only limits; auto without it\n"
    "  --parent PID                ends with that process's thread that started it\n"
    "  --seconds N                 limit of processor time\n"
    "  --addresses KIB             limit of memory, as addresses\n"
    "  --without LIST              as on a machine without landlock, namespaces, seccomp (with commas "
    "between)\n";

struct Options {
    bool report = false;
    std::string_view sandbox = "auto";
    std::optional<std::uint64_t> parent;
    sandbox::Limits limits;
    sandbox::Without without;
};

bool parseNumber(std::string_view text, std::uint64_t& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

bool parseWithout(std::string_view list, sandbox::Without& without) {
    while (!list.empty()) {
        const auto word = list.substr(0, list.find(','));
        list.remove_prefix(std::min(list.size(), word.size() + 1));
        if (word == "landlock")
            without.landlock = true;
        else if (word == "namespaces")
            without.namespaces = true;
        else if (word == "seccomp")
            without.seccomp = true;
        else
            return false;
    }
    return true;
}

bool parseOption(std::string_view name, std::string_view value, Options& options) {
    if (name == "--sandbox") {
        options.sandbox = value;
        return value == "auto" || value == "require" || value == "off";
    }
    if (name == "--parent") return parseNumber(value, options.parent.emplace());
    if (name == "--seconds") return parseNumber(value, options.limits.processorSeconds);
    if (name == "--addresses") return parseNumber(value, options.limits.addressKib);
    return name == "--without" && parseWithout(value, options.without);
}

/// Where the program's own words begin; 0 for words that are no options.
int parse(int argc, char** argv, Options& options) {
    int at = 1;
    for (; at < argc && argv[at][0] == '-'; ++at) {
        if (std::string_view(argv[at]) == "--report") {
            options.report = true;
        } else if (at + 1 < argc && parseOption(argv[at], argv[at + 1], options)) {
            ++at;
        } else {
            return 0;
        }
    }
    return options.report == (at == argc) ? at : 0;
}

int refuse(const std::string& reason, int status) {
    std::fprintf(stderr, "%s\n", reason.c_str());
    return status;
}

/// Ends at once: nothing that a library does on the way out is allowed any more.
[[noreturn]] void report(const sandbox::Confinement& confinement) {
    const std::string text =
        confinement.holds + (confinement.lacks.empty() ? "" : "; without: " + confinement.lacks) + "\n";
    const bool said = ::write(STDOUT_FILENO, text.data(), text.size()) == ssize_t(text.size());
    ::_exit(said && confinement.lacks.empty() ? 0 : 1);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    const int first = parse(argc, argv, options);
    if (first == 0) {
        std::fputs(usage, stderr);
        return usageError;
    }
    if (options.parent)
        if (const auto ok = sandbox::dieWith(pid_t(*options.parent)); !ok)
            return refuse(ok.error().message, cannotRun);
    if (options.sandbox != "off" || options.report) {
        options.limits.writesNothing = true;
        const auto files = sandbox::allowedFor(options.report ? "/bin/true" : argv[first]);
        const auto done = sandbox::shutIn(files, options.report ? -1 : scanDescriptor, options.without);
        if (!done) return refuse(done.error().message, cannotRun);
        if (options.report) report(*done);
        if (options.sandbox == "require" && !done->lacks.empty())
            return refuse("--importer-sandbox=require, but there is no complete sandbox here: " + done->lacks,
                          cannotRun);
    }
    // Last: the launcher itself needs more, built with a sanitizer.
    sandbox::setLimits(options.limits);
    ::execv(argv[first], argv + first);
    return refuse(std::string(argv[first]) + ": " + systemReason(errno),
                  errno == ENOENT ? notFound : cannotRun);
}
