// Of pictures by ranks, what goes from one to another, looked at without a picture. Each says on standard error what is wrong, and
// how much.
#pragma once

#include "ranks/mpi/communicator.hpp"

namespace scancast {

/// All ranks call it. Spans and words that are exchanged arrive where they belong: some, none, and nothing at all.
int spansArrive(const Communicator& ranks);
/// A drawing in which nothing is as it is by default arrives.
int everythingTravels();

}  // namespace scancast
