// What every command that makes a cloud file is told: where to, in how much memory, by how many threads. Of `ingest` and of `distance`;
// one table for both, used on the command's thread.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>

#include "protocol/error.hpp"
#include "server/base/byte_size.hpp"

namespace scancast {

struct MakingFlags {
    std::string output, memoryLimit;  ///< as written
    int threads = 0;                  ///< 0 = all cores
    bool force = false, quiet = false;
};

inline constexpr const char* memoryOfMaking =
    "Memory to stay within, such as 2G. Default: half of the machine's. The file is the same whatever the "
    "limit";
inline constexpr const char* threadsOfMaking =
    "Number of threads; 0 = all cores. The file is the same whatever the number";

/// -o, which has to be given. `flags` must outlive the parse.
inline void addOutputFlag(CLI::App& command, MakingFlags& flags) {
    command.add_option("-o,--output", flags.output, "The cloud file to write")->required()->type_name("FILE");
}

/// --memory-limit, --threads, -f and -q. `memory`, `threads`: what is said of those two.
inline void addMakingFlags(CLI::App& command, MakingFlags& flags, const std::string& memory = memoryOfMaking,
                           const std::string& threads = threadsOfMaking) {
    command.add_option("--memory-limit", flags.memoryLimit, memory)->type_name("SIZE");
    command.add_option("--threads", flags.threads, threads)
        ->check(CLI::Range(0, 4096))
        ->capture_default_str()
        ->type_name("N");
    command.add_flag("-f,--force", flags.force, "Replace the cloud file if it exists");
    command.add_flag("-q,--quiet", flags.quiet, "No progress and no summary on standard error");
}

/// Bytes; 0 where nothing was said. InvalidArgument for what is no size.
inline Expected<std::uint64_t> memoryLimitOf(const MakingFlags& flags) {
    return flags.memoryLimit.empty() ? Expected<std::uint64_t>(0)
                                     : parseByteSize(flags.memoryLimit, "memory-limit");
}

/// InvalidArgument for an output that is there, without --force.
inline Expected<void> checkOutput(const MakingFlags& flags) {
    std::error_code error;
    if (!flags.force && std::filesystem::exists(flags.output, error))
        return fail(ErrorCode::InvalidArgument, flags.output + " is there already; --force replaces it.",
                    "output");
    return {};
}

}  // namespace scancast
