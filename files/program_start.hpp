// What every program of ours does first, before any thread starts: nothing that happens to its standard
// streams, or to the room for its files, may end it by a signal.
#pragma once

namespace scancast {

/// SIGPIPE (a reader went away) and SIGXFSZ (a file may not grow further) become the errors EPIPE and EFBIG
/// of what was being written. Standard streams that are closed lead to /dev/null: else the next file opened
/// would get their numbers, and the log would be written into it. Importers keep the defaults: they have
/// nothing to do once their reader is gone.
void startProgram();

}  // namespace scancast
