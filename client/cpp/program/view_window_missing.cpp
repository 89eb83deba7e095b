// What `view` says where SDL2 was missing when it was built.
#include "client/cpp/program/view_window.hpp"

namespace scancast::client {

Expected<void> checkDisplay() {
    return fail(ErrorCode::Unsupported,
                "this scancast-client was built without windows: install libsdl2-dev and build it again");
}

Expected<void> runWindow(const Server&, WindowOptions) {
    return checkDisplay();
}

}  // namespace scancast::client
