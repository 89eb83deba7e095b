// How much memory a picture takes, for whoever must know before it is there. Pure functions; any thread.
#pragma once

#include <cstdint>

#include "server/scheduler/picture_order.hpp"

namespace scancast {

/// While it is drawn and encoded: its frame, the encoder's bytes and their copy, as large as they hardly ever are.
/// Drawing needs more, but no more for large pictures than for a screenful (renderer/render.hpp).
std::uint64_t bytesToDraw(const View& view, PictureFormat format);
std::uint64_t bytesToDraw(const PictureOrder& order);
/// Afterwards, until it has been read: a good guess, since nobody knows how small a picture gets.
std::uint64_t bytesToKeep(const View& view, PictureFormat format);

}  // namespace scancast
