// Memory kept back for the way out of a shortage. Who asks for too much fails; but on the way from there to
// the boundary that tells of it, a little memory is needed in places that may not fail - Asio's strands queue
// what comes next in a destructor, and end the program if that throws. The first allocation that fails gives
// the reserve free, and it is put back when the failure has been dealt with.
//
// *Thread safety*: every function may be called from any thread; keepMemoryReserve() once, before others
// start.
#pragma once

namespace scancast {

/// From now on there is one, behind every operator new of this program.
void keepMemoryReserve();
/// Puts it back, if it was given free and there is room again.
void refillMemoryReserve() noexcept;

}  // namespace scancast
