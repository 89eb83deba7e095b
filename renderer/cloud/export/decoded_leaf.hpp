// The points of one leaf that are wanted, out of its blocks. Pipeline: cloud file → **leaf** → cloud points. Any thread.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/file/exact_places.hpp"

namespace scancast {

struct DecodedLeaf {
    std::vector<Sample> samples;     ///< all of them
    std::vector<glm::dvec3> places;  ///< the same, file coordinates
    std::vector<std::byte> rows;  ///< the same, with all of the file's columns; empty where none are wanted
    std::vector<CorridorPlace> along;   ///< of those that are kept, where there is a corridor
    std::vector<std::uint32_t> kept{};  ///< which of them are wanted; of a whole leaf empty
    bool whole = false;

    std::size_t size() const { return whole ? samples.size() : kept.size(); }
    std::size_t at(std::size_t i) const { return whole ? i : kept[i]; }
};

/// Knows what of a file's blocks says where points are.
class LeafDecoder {
  public:
    LeafDecoder(std::shared_ptr<const CloudFile> file, const CloudPointsOptions& options);

    const std::shared_ptr<const CloudFile>& file() const { return file_; }
    /// Among the file's columns: those that positions and normals come out of, where it has them.
    const std::optional<std::array<std::size_t, 3>>& positions() const { return positions_; }
    const std::optional<std::array<std::size_t, 3>>& normals() const { return normals_; }

    /// Errors: the file's. Reads no more blocks than it must: none beside the samples where no point is wanted.
    Expected<DecodedLeaf> decode(const WantedLeaf& leaf, bool wantsRows) const;

  private:
    Expected<void> placePoints(std::uint32_t index, DecodedLeaf& leaf) const;
    void placeByRows(DecodedLeaf& leaf) const;
    void keepWanted(std::uint32_t index, DecodedLeaf& leaf) const;

    std::shared_ptr<const CloudFile> file_;
    ExactPlaces places_;
    std::shared_ptr<const RegionTest> region_;
    std::shared_ptr<const Corridor> corridor_;
    std::vector<ColumnType> types_;
    std::optional<std::array<std::size_t, 3>> positions_, normals_;  ///< among the file's columns
};

}  // namespace scancast
