// Of pictures by ranks, what goes from one to another, looked at without a picture. Each says on standard error what is wrong, and
// how much.
#pragma once

#include "ranks/mpi/communicator.hpp"

namespace scancast {

/// All ranks call it. What is reduced is everybody's, as numbers: in 32 bits and in 64, of sums that take more than 32.
int reductionsAddUp(const Communicator& ranks);
/// A drawing in which nothing is as it is by default arrives.
int everythingTravels();

}  // namespace scancast
