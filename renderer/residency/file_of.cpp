#include "renderer/residency/file_of.hpp"

namespace scancast {
namespace {

/// Columns and planes are a file's: what was read into memory has none.
CloudFacts factsInMemory(const Cloud& cloud) {
    CloudFacts facts = cloud;
    facts.columns.clear();
    facts.companions.clear();
    facts.photos.clear();
    facts.exact = false;
    return facts;
}

class CloudInMemory final : public CloudFile {
  public:
    explicit CloudInMemory(std::shared_ptr<const Cloud> cloud)
        : cloud_(std::move(cloud)), name_(cloud_->title), facts_(factsInMemory(*cloud_)) {
        nodes_.reserve(cloud_->octree.nodes().size());
        for (const Node& node : cloud_->octree.nodes()) nodes_.push_back({node, {}});
    }

    const std::filesystem::path& path() const override { return name_; }
    std::uint64_t bytes() const override { return 0; }
    const CloudFacts& facts() const override { return facts_; }
    std::span<const StoredNode> nodes() const override { return nodes_; }
    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        const auto run = cloud_->octree.run(node);
        if (!run) return passOn(run);
        return std::vector<Sample>(run->samples.begin(), run->samples.end());
    }
    std::span<const ValuePlane> planes() const override { return {}; }
    Expected<std::vector<std::byte>> plane(std::uint32_t, std::size_t) const override {
        return std::vector<std::byte>();
    }
    BlockPlace planePlace(std::uint32_t, std::size_t) const override { return {}; }
    Expected<std::vector<std::byte>> rows(std::uint32_t) const override { return std::vector<std::byte>(); }

  private:
    const std::shared_ptr<const Cloud> cloud_;
    const std::filesystem::path name_;
    const CloudFacts facts_;
    std::vector<StoredNode> nodes_;
};

}  // namespace

Expected<std::shared_ptr<const CloudFile>> fileOf(const std::shared_ptr<const Cloud>& cloud) {
    if (!cloud->octree.nodes().empty()) {
        if (auto file = cloud->octree.store().cloudFile()) return file;
        if (cloud->octree.store().whole()) return std::make_shared<CloudInMemory>(cloud);
    }
    return fail(
        ErrorCode::Unsupported,
        "The points of this cloud are with other processes than this one, which can show them and not "
        "give them away; serve its cloud file with scancast serve, or use scancast export.");
}

}  // namespace scancast
