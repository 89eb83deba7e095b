// A small tree of files in place of the machine's: for kernels that have namespaces and no Landlock. Used by the launcher, once.
// Pipeline: scan → **sandbox** → importer process.
#pragma once

#include "importers/sandbox/allowed_files.hpp"
#include "protocol/error.hpp"

namespace scancast::sandbox {

/// From now on this process, and what it becomes, sees what `files` lists and `scan`, what is open there, and nothing of it can be written to; there is
/// no network. Whoever may not do that as he is does it in a namespace of users. `scan` is opened anew, in there.
/// Errors: Unsupported where namespaces are not allowed, Io when a scan has been moved away meanwhile.
Expected<void> enterSmallRoot(const AllowedFiles& files, int scan);

}  // namespace scancast::sandbox
