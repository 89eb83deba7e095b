#include "renderer/residency/pictured_octree.hpp"

#include <algorithm>

#include "renderer/cloud/columns/pictured_file.hpp"
#include "renderer/residency/block_cache.hpp"

namespace scancast {
namespace {

/// Of a cloud in memory: what its samples have beside them is all that there is.
CloudFacts factsOfSamples(const Cloud& cloud) {
    CloudFacts facts = cloud;
    facts.columns.clear();
    facts.photos.clear();
    facts.exact = false;
    std::erase_if(facts.companions, [](const ValuePlane& plane) {
        return plane != curvaturePlane() && plane != nearInfraredPlane();
    });
    return facts;
}

tl::unexpected<Error> gone() {
    return fail(ErrorCode::Cancelled, "The cloud is not there any more.");
}

/// A cloud in memory as a file that does not keep it.
class SamplesInMemory final : public CloudFile {
  public:
    SamplesInMemory(const Cloud& cloud, const SampleStore& store)
        : gate_(store.gate()), name_(cloud.title), facts_(factsOfSamples(cloud)) {
        nodes_.reserve(cloud.octree.nodes().size());
        for (const Node& node : cloud.octree.nodes()) nodes_.push_back({node, {}});
    }

    const std::filesystem::path& path() const override { return name_; }
    std::uint64_t bytes() const override { return 0; }
    const CloudFacts& facts() const override { return facts_; }
    std::span<const StoredNode> nodes() const override { return nodes_; }
    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        using Samples = Expected<std::vector<Sample>>;
        return gate_->with<Samples>(
            [&](SampleStore& store) -> Samples {
                const auto run = store.load(node);
                if (!run) return passOn(run);
                return std::vector<Sample>(run->samples.begin(), run->samples.end());
            },
            gone());
    }
    std::span<const ValuePlane> planes() const override { return facts_.companions; }
    Expected<std::vector<std::byte>> plane(std::uint32_t node, std::size_t index) const override {
        using Bytes = Expected<std::vector<std::byte>>;
        const bool isCurvature = facts_.companions[index] == curvaturePlane();
        return gate_->with<Bytes>(
            [&](SampleStore& store) -> Bytes {
                const auto run = store.load(node);
                if (!run) return passOn(run);
                return isCurvature ? curvaturesOf(run->beside) : nearInfraredOf(run->beside);
            },
            gone());
    }
    BlockPlace planePlace(std::uint32_t, std::size_t) const override { return {}; }
    Expected<std::vector<std::byte>> rows(std::uint32_t) const override { return std::vector<std::byte>(); }

  private:
    static std::vector<std::byte> curvaturesOf(std::span<const BesideWord> beside) {
        std::vector<BesideWord> words(beside.begin(), beside.end());
        for (BesideWord& word : words) word = curvatureIn(word);
        const auto bytes = std::as_bytes(std::span(words));
        return {bytes.begin(), bytes.end()};
    }
    static std::vector<std::byte> nearInfraredOf(std::span<const BesideWord> beside) {
        std::vector<std::byte> values;
        values.reserve(beside.size());
        for (const BesideWord word : beside) values.push_back(std::byte(nearInfraredIn(word)));
        return values;
    }

    const std::shared_ptr<StoreGate> gate_;
    const std::filesystem::path name_;
    const CloudFacts facts_;
    std::vector<StoredNode> nodes_;
};

/// Where nobody said in which memory: as much as the cloud itself takes, and room to work in.
std::shared_ptr<SampleStore> storeOfItsOwn(std::shared_ptr<const CloudFile> file, const Octree& octree) {
    const std::uint64_t room = std::uint64_t(256) << 20;
    BlockCacheOptions options;
    options.memoryLimit = room + 4 * octree.bytesResident();
    options.threads = 1;
    return BlockCache::create(options)->addDerived(std::move(file));
}

}  // namespace

std::shared_ptr<const CloudFile> fileOfSamples(const Cloud& cloud) {
    return std::make_shared<SamplesInMemory>(cloud, cloud.octree.store());
}

bool hasInnerNodes(const Octree& octree) {
    return octree.nodes().size() > 1;
}

Expected<std::shared_ptr<const Octree>> picturedOctree(const Cloud& cloud, const Style& style) {
    if (cloud.octree.nodes().empty()) return nullptr;
    return picturedOctree(cloud, cloud.octree.store(), style);
}

Expected<std::shared_ptr<const Octree>> picturedOctree(const Cloud& cloud, SampleStore& samples,
                                                       const Style& style) {
    if (style.filter.empty() && style.color != ColorSource::Column) return nullptr;
    const Octree& own = cloud.octree;
    // Columns are a file's: what was read into memory has none.
    const bool inMemory = !samples.cloudFile();
    auto choice = inMemory ? chooseColumns(factsOfSamples(cloud), style, false)
                           : chooseColumns(cloud, style, hasInnerNodes(own));
    if (!choice) return passOn(choice);
    if (choice->isNothing()) return nullptr;
    const auto gate = samples.gate();
    if (!gate)
        return fail(ErrorCode::Unsupported,
                    "The points of this cloud are with other processes than this one, which do not colour or "
                    "filter by columns; serve its cloud file with scancast serve.",
                    style.filter.empty() ? "color" : "filter");
    DerivedOctrees& derived = samples.derived();
    const std::string words = choice->words();
    if (auto known = derived.find(words)) return known;

    auto file = samples.cloudFile();
    SamplesAtHand atHand;
    if (file)
        atHand = [gate](std::uint32_t node) {
            using Run = std::optional<SampleRun>;
            return gate->with<Run>([&](SampleStore& store) { return store.find(node); }, std::nullopt);
        };
    else
        file = std::make_shared<SamplesInMemory>(cloud, samples);
    auto pictured = picturedFile(std::move(file), std::move(*choice), std::move(atHand));
    auto store = derived.storeFor(pictured);
    if (!store) store = storeOfItsOwn(std::move(pictured), own);
    std::vector<Node> nodes(own.nodes().begin(), own.nodes().end());
    return derived.keep(words, std::make_shared<const Octree>(std::move(nodes), std::move(store)));
}

Expected<std::shared_ptr<const Cloud>> filteredCloud(std::shared_ptr<const Cloud> cloud, Style style) {
    style.color = ColorSource::Auto;
    const auto pictured = picturedOctree(*cloud, style);
    if (!pictured) return passOn(pictured);
    if (!*pictured) return cloud;
    // Whose samples are filtered must live as long.
    struct Filtered {
        std::shared_ptr<const Cloud> whole;
        Cloud left;
    };
    const auto made = std::make_shared<Filtered>(Filtered{cloud, *cloud});
    made->left.octree = **pictured;
    return std::shared_ptr<const Cloud>(made, &made->left);
}

}  // namespace scancast
