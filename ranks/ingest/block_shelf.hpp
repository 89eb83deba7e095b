// Finished blocks of one rank, one behind the other in its workspace, until rank 0 puts everybody's into the cloud file. Owned by the
// ingest; read from any thread while nobody appends. Pipeline: octree builder → **shelf** → cloud file.
#pragma once

#include <vector>

#include "renderer/cloud/build/workspace.hpp"
#include "renderer/cloud/file/block_sink.hpp"

namespace scancast {

class BlockShelf final : public BlockSink {
  public:
    explicit BlockShelf(Workspace& workspace) : workspace_(workspace) {}

    Expected<BlockPlace> append(std::span<const std::byte> block) override;
    Expected<std::vector<std::byte>> readBack(const BlockPlace& place) const override;
    std::uint64_t bytes() const { return bytes_; }
    /// Any bytes that are there. Errors: the workspace's.
    Expected<void> read(std::uint64_t offset, std::span<std::byte> into) const;

  private:
    static constexpr std::uint64_t boardBytes = std::uint64_t(4) << 20;

    Workspace& workspace_;
    std::vector<Workspace::Buffer> boards_;  ///< boardBytes each, all but the last full
    std::uint64_t bytes_ = 0;
};

}  // namespace scancast
