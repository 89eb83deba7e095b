// What lets others in while a picture is drawn that takes long. Pipeline: scheduler → draw → **device**.
#pragma once

#include <functional>

namespace scancast {

/// Called on the thread that draws, between slices of about ten milliseconds at most. It may draw other pictures
/// with the same device, each from its begin() to its finish(), before it returns; then the picture goes on as if
/// nothing had been. Throws nothing. Empty = nobody is let in.
using Pause = std::function<void()>;

}  // namespace scancast
