// The cloud file (CLOUD_FILE.md): an octree on disk. Opens by its index alone, in milliseconds at any size;
// blocks are read one by one, checked before they are decoded. Nothing is memory-mapped: a truncated file is
// an error, not a signal. Files of versions 1 and 2 are read, too; who reads them sees no difference.
// Pipeline: ingest → **cloud file** → residency.
//
// *Thread safety*: a CloudFile may be read from any number of threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "files/input_file.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_place.hpp"
#include "renderer/cloud/file/kept_point.hpp"

namespace scancast {

class RandomReader;

class CloudFile {
  public:
    /// Errors name the file, the offset and the reason: NotFound, Io, Unsupported (not a cloud file, another
    /// version), Truncated, Malformed.
    static Expected<std::shared_ptr<const CloudFile>> open(const std::filesystem::path& path);
    /// What somebody opened.
    static Expected<std::shared_ptr<const CloudFile>> open(InputFile file);
    /// The same over any bytes. `name` is what path() says and messages call it.
    static Expected<std::shared_ptr<const CloudFile>> open(std::unique_ptr<RandomReader> reader,
                                                           const std::filesystem::path& name);
    virtual ~CloudFile() = default;

    virtual const std::filesystem::path& path() const = 0;
    virtual std::uint64_t bytes() const = 0;  ///< size on disk
    /// Its blocks come over a network: waiting for many is as quick as for one.
    virtual bool isRemote() const { return false; }
    /// It is a scan that is shown as it is, in its own octree (renderer/cloud/native): sampleCount and points of its nodes are
    /// estimates, and samples() says how many there are.
    virtual bool isNative() const { return false; }
    /// Nodes may have another number of samples than their sampleCount says: samples() tells.
    virtual bool countsVary() const { return isNative(); }
    /// Bytes that it takes itself beside its nodes, for as long as it is open.
    virtual std::uint64_t ownMemory() const { return 0; }
    /// No block can be had at present but those that have been: what they come from is out of reach.
    virtual bool isAway() const { return false; }
    /// Their photos' data may be read for as long as anybody has them, whatever becomes of this object.
    virtual const CloudFacts& facts() const = 0;
    /// Where the bytes of facts().photos are.
    virtual std::span<const BlockPlace> photoPlaces() const { return {}; }
    /// Program and version that wrote it: "scancast 0.1.0".
    virtual std::string_view writtenBy() const { return {}; }
    virtual std::span<const StoredNode> nodes() const = 0;
    /// One node's samples. Errors: Malformed or Truncated, naming node and place; Io; Unavailable.
    virtual Expected<std::vector<Sample>> samples(std::uint32_t node) const = 0;

    /// What there is beside the samples: facts().columns, in their order, then facts().companions.
    virtual std::span<const ValuePlane> planes() const = 0;
    /// One node's values of planes()[index], packed, in the order of its samples; empty where it has none.
    /// Errors: as samples().
    virtual Expected<std::vector<std::byte>> plane(std::uint32_t node, std::size_t index) const = 0;
    /// Which block plane() reads, of a node and a plane that there are. Columns of a version 1 file share one.
    virtual BlockPlace planePlace(std::uint32_t node, std::size_t index) const = 0;
    /// All facts().columns of one node in rows, in the order of its samples; inner nodes and clouds without have
    /// none.
    virtual Expected<std::vector<std::byte>> rows(std::uint32_t node) const = 0;
    /// All that is known of one of a leaf's points: the one whose sample is samples[index], of what samples() gives. Waits for
    /// what it is read from. Errors: as samples().
    virtual Expected<KeptPoint> point(std::uint32_t leaf, std::span<const Sample> samples,
                                      std::size_t index) const;
};

/// Whether a file with these first bytes is (meant to be) a cloud file.
bool isCloudFile(std::span<const std::byte> start);
/// The same by a look at them. Files that cannot be read are none.
bool isCloudFile(const InputFile& file);

}  // namespace scancast
