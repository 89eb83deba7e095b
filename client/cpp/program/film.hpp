// A walk of the camera over the live stream, every step a picture: what `orbit` and `path` have in common.
#pragma once

#include <functional>

#include "client/cpp/program/command.hpp"
#include "protocol/view/view.hpp"

namespace scancast::client {

struct FilmFlags {
    std::string output;
    double framesPerSecond = 30;  ///< of a video
    bool moving = false, quiet = false;

    void addTo(CLI::App& command);
};

/// Takes picture 0 to `count` - 1 of the cloud, at the view that `at` says, and prints how long that took.
Expected<void> film(const Server& server, const std::string& cloud, const FilmFlags& flags, int count,
                    const std::function<View(int)>& at);

}  // namespace scancast::client
