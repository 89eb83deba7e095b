// Files beneath a folder, by name, each read whole: a folder of this machine, objects beside each other behind a URL (remote/), or memory in
// tests and fuzzers. Names are made by who reads, of letters, digits, dots, dashes and slashes; never of what comes from outside.
// Pipeline: disk, network → **files** → a scan that consists of many. *Thread safety*: everything from any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "files/input_folder.hpp"

namespace scancast {

class FolderReader {
  public:
    virtual ~FolderReader() = default;
    /// All of a file: `name` as "ept-data/0-0-0-0.laz". Waits. Errors, which call it "its file NAME": NotFound, Io; ResourceLimit for more
    /// than `most` bytes; Unavailable where the network brings nothing at present, and may later.
    virtual Expected<std::vector<std::byte>> read(const std::string& name, std::uint64_t most) const = 0;
    /// It will be read soon: where that takes a while, it begins now. Never waits.
    virtual void expect(const std::string&, std::uint64_t /*most*/) const {}
    /// Drops what is kept of it; true = read again, it may be another.
    virtual bool forget(const std::string&) const { return false; }
    /// Of all files; 0 where nobody knows.
    virtual std::uint64_t bytes() const { return 0; }
    /// Reading waits for others, not for this machine.
    virtual bool isRemote() const { return false; }
    /// At present there is no reaching what they come from: what is not here yet is Unavailable.
    virtual bool isAway() const { return false; }
};

std::shared_ptr<const FolderReader> readerOf(InputFolder folder);

}  // namespace scancast
