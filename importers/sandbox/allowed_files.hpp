// Which files an importer may read and which it may become: itself, its interpreter, libraries - and nothing else of this machine.
// Worked out by its launcher, once, before anything is shut. Pipeline: scan → **sandbox** → importer process.
#pragma once

#include <string>
#include <vector>

namespace scancast::sandbox {

struct AllowedFiles {
    std::vector<std::string> readable;    ///< files, and folders with all that is in them
    std::vector<std::string> executable;  ///< files
};

/// For `program` (absolute): itself; if it is a script, what its first line starts, through `env` too, and the folder that it really
/// lies in, with the modules there; of each the loader of shared libraries. The libraries are those of the system and of
/// LD_LIBRARY_PATH. What is not there is left out later.
AllowedFiles allowedFor(const std::string& program);

}  // namespace scancast::sandbox
