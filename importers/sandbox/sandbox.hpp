// What shuts an importer in, step by step, with what this machine has: the launcher's order of things. Pipeline: scan → **sandbox** → importer process.
#pragma once

#include <string>
#include <string_view>

#include "importers/sandbox/allowed_files.hpp"
#include "protocol/error.hpp"

namespace scancast::sandbox {

/// Of the machine, to be done without, as if the kernel had none: how tests see what happens then.
struct Without {
    bool landlock = false, namespaces = false, seccomp = false;
};

/// What holds, and what does not, for people: parts of a sentence, empty where there is nothing to say.
struct Confinement {
    std::string holds, lacks;
};

/// Files: by Landlock, else by a small tree of mounts, else, of the superuser, by becoming another user. Then capabilities, then system calls.
/// `scan`: the descriptor that may be read, or -1. Error: what the kernel refuses that it has to do anywhere.
Expected<Confinement> shutIn(const AllowedFiles& files, int scan, const Without& without);

}  // namespace scancast::sandbox
