// Decides how a cloud is best seen when nobody has said anything (protocol/look.hpp): finds out what kind of
// scene it is, then looks at it - from many places, in small pictures drawn by the cpu device, whatever draws
// later - and takes what shows most. The same for the same octree on any number of threads. Pipeline: cloud →
// **look** → first view.
#pragma once

#include <memory>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Reads the upper levels of the octree; a fraction of a second for any cloud. Errors: those of drawing.
Expected<Look> decideLook(const Cloud& cloud);

/// The cloud with a look: its own, or one that is decided now. A cloud that cannot be looked at stays as it
/// is: it is shown as one without.
std::shared_ptr<const Cloud> withLook(std::shared_ptr<const Cloud> cloud);

}  // namespace scancast
