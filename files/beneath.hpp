// Opens what lies beneath a folder, and nothing else: no name and no link leads out of it, whatever others
// rename meanwhile. Free functions; any thread. Used by InputFolder.
#pragma once

#include <filesystem>
#include <tl/expected.hpp>

#include "files/unique_fd.hpp"

namespace scancast {

/// An errno: EXDEV for a name that leads out of the folder (".." too far, an absolute path, an absolute
/// link), ELOOP for too many links.
using OpenedBeneath = tl::expected<UniqueFd, int>;

/// Opens with inputFlags. `folder` may have been opened with O_PATH. Links are followed as long as they stay
/// beneath it.
OpenedBeneath openBeneath(int folder, const std::filesystem::path& name);

/// The two ways to do it; they give the same. By the kernel: ENOSYS or EPERM where it (before Linux 5.6), or
/// what a container lets through, has no openat2().
OpenedBeneath openBeneathByKernel(int folder, const std::filesystem::path& name);
/// Component by component, each opened in the one before without following links, which are read and taken
/// apart.
OpenedBeneath openBeneathByHand(int folder, const std::filesystem::path& name);

}  // namespace scancast
