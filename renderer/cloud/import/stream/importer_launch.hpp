// How an importer is started: through scancast-sandbox, which sets its limits, shuts it in and becomes it (decision 18). Functions for any thread; a thread of
// its own does the starting, so that a program ends with this process and not with whoever asked for it. Pipeline: file → **importer process** → point stream → points.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "files/unique_fd.hpp"
#include "renderer/cloud/import/stream/importer_process.hpp"

namespace scancast {

/// The scan's, in the importer.
inline constexpr int scanDescriptor = 3;

struct LaunchedProgram {
    pid_t pid = -1;
    UniqueFd output, errors;  ///< the ends to read of its standard output and error; reading does not wait
    UniqueFd input{};  ///< the end to write of its standard input, where it has one; writing does not wait
};

/// What a program finds on its standard input.
enum class ProgramInput : std::uint8_t { Nothing, Pipe };

/// Starts arguments[0] in a process group of its own, with `scan` as scanDescriptor if it is not -1, without
/// other descriptors and with a small environment. Errors: Io, Importer.
Expected<LaunchedProgram> launch(std::vector<std::string> arguments, int scan,
                                 ProgramInput input = ProgramInput::Nothing);

/// scancast-sandbox with what `options` allow, and then the importer with its words.
Expected<std::vector<std::string>> importerCommand(const ImporterProgram& importer, const std::string& file,
                                                   const ImportOptions& options);

/// Where scancast-sandbox is: as importers, but beside the running program also when options name another
/// folder for them. Error: Importer.
Expected<std::filesystem::path> findSandbox(const ImportOptions& options);

}  // namespace scancast
