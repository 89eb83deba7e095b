#include "renderer/together/together.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <utility>

#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/crs_units.hpp"
#include "renderer/residency/node_share.hpp"
#include "renderer/residency/pictured_octree.hpp"
#include "renderer/together/together_facts.hpp"
#include "renderer/together/together_store.hpp"

namespace scancast {
namespace {

/// What samples without colours are drawn in where others have some.
constexpr Rgb8 noColor{200, 200, 200};

std::string calledCrs(const CloudFacts& facts) {
    std::string name = crsName(facts.crsWkt, facts.crsEpsg);
    return name.empty() ? "a coordinate reference system without a name" : name;
}

std::string calledUnit(const CrsUnits& units) {
    return units.unit.empty() ? "another unit" : units.unit;
}

/// One system and one unit, as far as both clouds say. Coordinates mean something else otherwise, and lie where they do not belong.
Expected<void> checkSameSystem(const TogetherMember& own, const TogetherMember& other) {
    const auto refuse = [](std::string why) {
        return fail(ErrorCode::Unsupported, "with: " + std::move(why), "with");
    };
    const auto a = crsMeaning(own.cloud->crsWkt, own.cloud->crsEpsg);
    const auto b = crsMeaning(other.cloud->crsWkt, other.cloud->crsEpsg);
    if (!a || !b) return {};
    if (compare(*a, *b) == CrsRelation::Different)
        return refuse(
            fmt::format("\"{}\" is in {}, and \"{}\" in {}: clouds of different coordinate reference systems "
                        "cannot be shown together. Bring the scans into one first.",
                        own.name, calledCrs(*own.cloud), other.name, calledCrs(*other.cloud)));
    const CrsUnits mine = crsUnits(own.cloud->crsWkt, own.cloud->crsEpsg);
    const CrsUnits theirs = crsUnits(other.cloud->crsWkt, other.cloud->crsEpsg);
    const auto differ = [](double one, double another) {
        return one > 0 && another > 0 && std::abs(one - another) > 1e-9 * one;
    };
    if (differ(mine.metres, theirs.metres))
        return refuse(fmt::format(
            "\"{}\" is in {}, and \"{}\" in {}: clouds of different units cannot be shown together.",
            own.name, calledUnit(mine), other.name, calledUnit(theirs)));
    if (differ(mine.verticalMetres, theirs.verticalMetres))
        return refuse(
            fmt::format("heights of \"{}\" are in {}, those of \"{}\" in {}: clouds of different units "
                        "cannot be shown together.",
                        own.name, mine.verticalUnit, other.name, theirs.verticalUnit));
    return {};
}

/// What other processes have cannot be put together here.
Expected<void> checkHere(const TogetherMember& member) {
    const SampleStore& store = member.cloud->octree.store();
    if (!placeOfShared(store) && (store.whole() || store.cloudFile())) return {};
    return fail(ErrorCode::Unsupported,
                "with: the points of \"" + member.name +
                    "\" are with other processes than this one, which draw one cloud at a time; serve the "
                    "clouds with "
                    "scancast serve to see them together.",
                "with");
}

bool isShown(const TogetherMember& member) {
    return !member.hidden && !member.cloud->octree.nodes().empty();
}

std::optional<Paint> paintOf(const TogetherMember& member, std::size_t place, bool byCloud, bool anyColors) {
    if (byCloud) return Paint{member.tint.value_or(cloudColors[place % cloudColors.size()]), true};
    const bool hasOwn = hasColors(*member.cloud);
    if (member.tint) return Paint{*member.tint, !hasOwn};
    if (anyColors && !hasOwn) return Paint{noColor, true};
    return std::nullopt;
}

using MakeStore = std::function<std::shared_ptr<SampleStore>(std::shared_ptr<const CloudFile>)>;

/// Where the samples come from that are drawn of a cloud.
Expected<std::shared_ptr<SampleStore>> storeOf(const Cloud& cloud, const std::optional<Paint>& paint,
                                               const MakeStore& make) {
    if (!paint) return cloud.octree.sharedStore();
    auto file = cloud.octree.store().cloudFile();
    if (!file) file = fileOfSamples(cloud);
    if (auto made = make(paintedFile(std::move(file), *paint))) return made;
    return fail(ErrorCode::Cancelled, "The clouds are not there any more.");
}

/// Painted blocks that are there already, and what devices know of them, stay.
std::shared_ptr<SampleStore> keptStore(const Together* before, const TogetherMember& member,
                                       const std::optional<Paint>& paint) {
    for (std::size_t i = 0; before != nullptr && paint && i < before->members.size(); ++i)
        if (before->stores[i] && before->members[i].cloud == member.cloud && before->paints[i] == paint)
            return before->stores[i];
    return nullptr;
}

MakeStore storesIn(const std::shared_ptr<BlockCache>& cache) {
    return [cache =
                std::weak_ptr(cache)](std::shared_ptr<const CloudFile> file) -> std::shared_ptr<SampleStore> {
        const auto there = cache.lock();
        return there ? there->add(std::move(file)) : nullptr;
    };
}

/// Bytes of the nodes of all clouds that are put together now.
std::atomic<std::uint64_t> bytesTogether{0};

/// Nodes cannot be given up while somebody draws them, so there is a limit to all of them, beside each one's.
Expected<std::shared_ptr<const void>> countNodes(const std::weak_ptr<BlockCache>& cache, std::uint64_t nodes) {
    struct Counted {
        std::uint64_t bytes;
        std::shared_ptr<const void> reserved{};
        explicit Counted(std::uint64_t taken) : bytes(taken) { bytesTogether += bytes; }
        ~Counted() { bytesTogether -= bytes; }
        Counted(const Counted&) = delete;
        Counted& operator=(const Counted&) = delete;
    };
    const auto there = cache.lock();
    if (!there) return fail(ErrorCode::Cancelled, "The clouds are not there any more.");
    auto counted = std::make_shared<Counted>(nodes * bytesPerNodeTogether);
    if (bytesTogether > there->stats().limit / 4)
        return fail(ErrorCode::Unavailable,
                    "with: the views of several clouds that are shown now take all the memory that there is for "
                    "these; ask again in a moment, or hide some clouds.",
                    "with");
    counted->reserved = there->reserve(counted->bytes);
    return counted;
}

/// Level by level, and in each member by member: breadth first, as all octrees are.
class Gathering {
  public:
    Gathering(const Together& together, const glm::dvec3& origin, bool markSides) {
        for (const TogetherMember& member : together.members) {
            const bool isSure = markSides && member.cloud->oriented;
            parts_.push_back(
                {member.cloud->octree.nodes(), member.cloud->origin + member.shift - origin, isSure, {}, 0});
            if (!isShown(member)) parts_.back().nodes = {};
        }
    }

    void run(std::vector<Node>& nodes, std::vector<Together::Place>& places) {
        for (Part& part : parts_) part.places.assign(part.nodes.size(), noNode);
        for (bool more = true; more;) {
            more = false;
            for (std::uint32_t p = 0; p < parts_.size(); ++p) more = addLevel(p, nodes, places) || more;
        }
        for (std::size_t i = 0; i < nodes.size(); ++i) link(nodes[i], parts_[places[i].member]);
    }

  private:
    struct Part {
        std::span<const Node> nodes;
        glm::dvec3 offset;
        bool isSure;
        std::vector<std::uint32_t> places;  ///< in the octree of all, by node
        std::uint32_t next;                 ///< the first node that is not there yet
    };

    /// The nodes whose parents are there, which are those up to the first that is a child of one of this level.
    bool addLevel(std::uint32_t p, std::vector<Node>& nodes, std::vector<Together::Place>& places) {
        Part& part = parts_[p];
        const std::uint32_t begin = part.next;
        for (; part.next < part.nodes.size(); ++part.next) {
            const std::uint32_t parent = part.nodes[part.next].parent;
            if (parent != noNode && parent >= begin) break;
            part.places[part.next] = static_cast<std::uint32_t>(nodes.size());
            nodes.push_back(moved(part.nodes[part.next], part));
            places.push_back({p, part.next});
        }
        return part.next > begin;
    }

    static Node moved(Node node, const Part& part) {
        node.boxMin += part.offset;
        node.boxMax += part.offset;
        node.center += part.offset;
        if (part.isSure) node.confidence = certainSide;
        return node;
    }

    static void link(Node& node, const Part& part) {
        if (node.parent != noNode) node.parent = part.places[node.parent];
        if (!node.isLeaf()) node.firstChild = part.places[node.firstChild];
    }

    std::vector<Part> parts_;
};

/// Whether nothing differs but where clouds lie.
bool hasSameSamples(const Together& a, const Together& b) {
    if (a.members.size() != b.members.size()) return false;
    for (std::size_t i = 0; i < a.members.size(); ++i) {
        if (isShown(a.members[i]) != isShown(b.members[i])) return false;
        if (!isShown(a.members[i])) continue;
        if (a.members[i].cloud != b.members[i].cloud || a.paints[i] != b.paints[i]) return false;
    }
    return true;
}

}  // namespace

Expected<std::shared_ptr<const Cloud>> putTogether(std::vector<TogetherMember> members, bool byCloud,
                                                   const std::shared_ptr<BlockCache>& cache,
                                                   const Cloud* like) {
    const Together* const before = like != nullptr ? like->together.get() : nullptr;
    std::uint64_t nodes = 0;
    for (const TogetherMember& member : members) {
        if (auto ok = checkSameSystem(members.front(), member); !ok) return passOn(ok);
        if (!isShown(member)) continue;
        if (auto ok = checkHere(member); !ok) return passOn(ok);
        nodes += member.cloud->octree.nodes().size();
    }
    const std::uint64_t most = std::min(mostNodesTogether, cache->stats().limit / 4 / bytesPerNodeTogether);
    if (nodes > most)
        return fail(
            ErrorCode::ResourceLimit,
            fmt::format(
                "with: these clouds have {} nodes, and {} may be shown together here; hide some of them, or "
                "ingest them as one cloud.",
                nodes, most),
            "with");

    auto together = std::make_shared<Together>();
    together->members = std::move(members);
    together->byCloud = byCloud;
    const auto& all = together->members;
    const bool anyColors = std::ranges::any_of(all, [](const TogetherMember& member) {
        return isShown(member) && (member.tint || hasColors(*member.cloud));
    });
    for (std::size_t i = 0; i < all.size(); ++i) {
        together->paints.push_back(paintOf(all[i], i, byCloud, anyColors));
        auto& store = together->stores.emplace_back();
        if (!isShown(all[i])) continue;
        store = keptStore(before, all[i], together->paints.back());
        if (store) continue;
        auto made = storeOf(*all[i].cloud, together->paints.back(), storesIn(cache));
        if (!made) return passOn(std::move(made));
        store = std::move(*made);
    }
    auto cloud = std::make_shared<Cloud>();
    static_cast<CloudFacts&>(*cloud) = factsTogether(*together);
    together->count = [cache = std::weak_ptr(cache)](std::uint64_t more) { return countNodes(cache, more); };
    auto counted = together->count(nodes);
    if (!counted) return passOn(std::move(counted));
    together->counted = std::move(*counted);
    std::vector<Node> gathered;
    gathered.reserve(nodes);
    together->places.reserve(nodes);
    Gathering(*together, cloud->origin, !cloud->oriented).run(gathered, together->places);
    cloud->together = together;
    const bool same = before != nullptr && hasSameSamples(*together, *before);
    auto store = togetherStore(together);
    store->derived().setStoreMaker(storesIn(cache));
    cloud->octree = Octree(std::move(gathered), std::move(store), same ? like->octree.source() : 0);
    return cloud;
}

}  // namespace scancast
