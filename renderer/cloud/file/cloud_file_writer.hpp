// Writes a cloud file front to back, beside its final name: the name appears when everything is written and
// safe on disk, or never. Pipeline: octree builder → **writer** → cloud file. Owned and used by one thread,
// except where said.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "files/unfinished_file.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_sink.hpp"

namespace scancast {

class CloudFileWriter : public BlockSink {
  public:
    /// Creates `<path>.partial`. What an earlier run left there is overwritten, unless that run still writes
    /// (it holds a lock): InvalidArgument. Errors: Io, NotFound (no such folder).
    static Expected<std::unique_ptr<CloudFileWriter>> create(const std::filesystem::path& path,
                                                             Readers readers = Readers::AsUsual);
    /// Removes the partial file unless finish() succeeded.
    ~CloudFileWriter() override = default;

    virtual std::uint64_t bytesWritten() const = 0;
    /// The file is not to be: its name beside the final one is gone when this returns, whatever its owner is doing, and finish() ends
    /// with Cancelled. Without effect once the file has its final name. From any thread, while it lives: whoever has a second to end in
    /// cannot wait for the owner.
    virtual void withdraw() = 0;
    /// The bytes of facts.photos, indices, facts, header; synced; renamed over `path`. Nodes in breadth-first order, root at 0. `planes`: where
    /// the values beside the samples are, for each node all of planesOf(facts), encoded by encodeRows(); a place
    /// of nothing where a node has none - inner nodes of columns, and of companions any node.
    /// Cancelled where `stop` is requested between two photos.
    virtual Expected<void> finish(const CloudFacts& facts, std::span<const StoredNode> nodes,
                                  std::span<const BlockPlace> planes, const std::stop_token& stop = {}) = 0;
};

}  // namespace scancast
