// Two numbers of double precision that are reckoned with at once, each as it would be alone: what a register of any
// machine that the house runs on holds.
#pragma once

namespace scancast {

typedef double Two __attribute__((vector_size(2 * sizeof(double))));

}  // namespace scancast
