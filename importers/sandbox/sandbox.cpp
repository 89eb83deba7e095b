#include "importers/sandbox/sandbox.hpp"

#include "importers/sandbox/landlock.hpp"
#include "importers/sandbox/privileges.hpp"
#include "importers/sandbox/small_root.hpp"
#include "importers/sandbox/system_calls.hpp"

namespace scancast::sandbox {
namespace {

void addTo(std::string& list, const std::string& text) {
    if (!list.empty()) list += ", ";
    list += text;
}

std::string landlockText() {
    const int version = landlockVersion();
    return "files by Landlock " + std::to_string(version) +
           (version >= 6   ? " (with TCP and signals)"
            : version >= 4 ? " (with TCP)"
                           : "");
}

/// Whether what may be opened is decided by something else than its owner.
bool shutFiles(const AllowedFiles& files, int scan, const Without& without, Confinement& result) {
    std::string why;
    if (without.landlock) {
        why = "this kernel has no Landlock";
    } else if (const auto done = shutByLandlock(files, scan)) {
        addTo(result.holds, landlockText());
        return true;
    } else {
        why = done.error().message;
    }
    if (!without.namespaces) {
        if (const auto done = enterSmallRoot(files, scan)) {
            addTo(result.holds, "files by a namespace of mounts, no network");
            return true;
        } else {
            why += " and " + done.error().message;
        }
    } else {
        why += " and this system does not allow namespaces";
    }
    if (const auto done = becomeNobody()) {
        addTo(result.holds, "files by a user of their own");
        addTo(result.lacks, why + ": they can read what every user may");
    } else {
        addTo(result.lacks, why + ", and " + done.error().message + ": they can read what the server may");
    }
    return false;
}

}  // namespace

Expected<Confinement> shutIn(const AllowedFiles& files, int scan, const Without& without) {
    Confinement result;
    if (auto ok = renouncePrivileges(); !ok) return passOn(ok);
    const bool shut = shutFiles(files, scan, without, result);
    dropCapabilities(shut);
    const auto calls =
        without.seccomp ? fail(ErrorCode::Unsupported, "this kernel has no filter of system calls (seccomp)")
                        : refuseSystemCalls();
    if (calls)
        addTo(result.holds, "system calls by seccomp (no sockets, no processes)");
    else
        addTo(result.lacks, calls.error().message + ": they can use the network and start programs");
    addTo(result.holds, "no privileges");
    return result;
}

}  // namespace scancast::sandbox
