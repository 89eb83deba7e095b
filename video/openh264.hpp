// OpenH264 (Cisco, BSD 2-clause), opened at run time: programs start and work without it, and say what to install. The only
// header beside its users that knows where the library's functions come from.
//
// Any thread.
#pragma once

#include <string>

#include "protocol/error.hpp"

class ISVCEncoder;
class ISVCDecoder;

namespace scancast {

/// The library's functions that this room calls. What they make is the caller's, and outlives nothing: the library stays open.
struct OpenH264 {
    int (*createEncoder)(ISVCEncoder**) = nullptr;
    void (*destroyEncoder)(ISVCEncoder*) = nullptr;
    long (*createDecoder)(ISVCDecoder**) = nullptr;
    void (*destroyDecoder)(ISVCDecoder*) = nullptr;
    std::string version;  ///< "2.3.1"
};

/// Opened once, at the first call. Unavailable, with a sentence that says what to install, where it cannot be had: it is not
/// on this machine, is of another version than this program was built for, or the program was built without it.
Expected<const OpenH264*> openH264();

}  // namespace scancast
