// The window of `scancast-client view`: SDL's events go in, views go to the server, frames come back.
//
// Built with SDL2 where that is installed. One thread, the main one, as window systems want it; frames arrive
// on the stream's thread and wait in a mailbox of one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/cpp/server.hpp"
#include "protocol/frame_header.hpp"

namespace scancast::client {

struct WindowOptions {
    CloudInfo cloud;
    View view;                         ///< its size is the window's at first
    std::vector<std::string> methods;  ///< that keys go through
    bool trace = false;                ///< says on standard output what happens, a line for each thing
    /// Ends by itself after so many final stills; for tests.
    std::optional<int> finals;
    std::vector<Codec> codecs{Codec::Jpeg};  ///< that moving frames may come in
};

/// Whether there is a display to open a window on, for who would rather ask before anything else. Errors:
/// DeviceUnavailable with the way out; Unsupported in a program that was built without windows.
Expected<void> checkDisplay();

/// Returns when the window is closed, or with the error that ended the stream.
Expected<void> runWindow(const Server& server, WindowOptions options);

}  // namespace scancast::client
