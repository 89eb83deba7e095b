#include "renderer/cloud/distance/measured_copy.hpp"

#include <spdlog/fmt/fmt.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <bit>
#include <new>

#include "renderer/cloud/distance/leaf_distances.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"

namespace scancast {

static_assert(std::endian::native == std::endian::little, "values stand in files as they are in memory");

/// A node as it goes into the file.
struct MeasuredCopy::Packed {
    std::uint32_t node = 0;
    std::vector<std::byte> samples;
    std::vector<std::vector<std::byte>> planes;  ///< of the new file, in their order
    std::vector<float> values;                   ///< of the new column, or of its companion
    bool isLeaf = false;
};

/// Of what the copy has more than the cloud.
class MeasuredCopy::Digest {
  public:
    Digest() : state_(XXH3_createState(), &XXH3_freeState) {
        if (!state_) throw std::bad_alloc();
        XXH3_128bits_reset(state_.get());
    }
    void add(std::string_view text) {
        const std::uint64_t size = text.size();
        add(std::as_bytes(std::span(&size, 1)));
        add(std::as_bytes(std::span(text)));
    }
    void add(std::span<const std::byte> bytes) {
        XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
    }
    std::string hex() const {
        const XXH128_hash_t h = XXH3_128bits_digest(state_.get());
        return fmt::format("{:016x}{:016x}", h.high64, h.low64);
    }

  private:
    std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

MeasuredCopy::MeasuredCopy(const CloudFile& cloud, const EarlierPoints& earlier, MeasuredCopyOptions options,
                           CloudFileWriter& writer)
    : cloud_(cloud),
      earlier_(earlier),
      options_(std::move(options)),
      writer_(writer),
      places_(cloud.facts(), &cloud),
      planes_(cloud.planes().size() + 2),
      subtree_(cloud.nodes().size(), 1),
      nodes_(cloud.nodes().begin(), cloud.nodes().end()),
      planePlaces_(cloud.nodes().size() * planes_),
      summary_(options_.most),
      digest_(std::make_unique<Digest>()) {
    for (std::size_t i = nodes_.size(); i-- > 1;) subtree_[nodes_[i].node.parent] += subtree_[i];
}

MeasuredCopy::~MeasuredCopy() = default;

Expected<CloudFacts> MeasuredCopy::write(const ProgressSink& progress, const std::stop_token& stop) {
    stop_ = stop;
    meter_ = std::make_unique<ProgressMeter>(progress, "measuring", nodes_.front().node.points);
    digest_->add(cloud_.facts().revision);
    digest_->add(options_.column.name);
    if (auto root = writeSubtree(0); !root) return passOn(root);
    meter_->finish();
    CloudFacts facts = factsOfCopy();
    if (auto ok = writer_.finish(facts, nodes_, planePlaces_, stop); !ok) return passOn(ok);
    return facts;
}

KeptColumn MeasuredCopy::column() const {
    KeptColumn kept{.column = options_.column};
    summary_.tell(kept);
    return kept;
}

CloudFacts MeasuredCopy::factsOfCopy() const {
    CloudFacts facts = cloud_.facts();
    facts.columns.push_back(column());
    facts.companions.push_back(innerPlane(options_.column));
    facts.revision = digest_->hex();
    return facts;
}

/// As much at once as there is room for; above that, child after child.
Expected<ValuedSamples> MeasuredCopy::writeSubtree(std::uint32_t index) {
    const Node& node = nodes_[index].node;
    const bool whole = node.isLeaf() || node.points <= options_.chunkPoints;
    std::vector<Packed> packed(whole ? subtree_[index] : 1);
    Expected<ValuedSamples> points;
    if (whole) {
        points = measure(index, packed);
    } else {
        std::vector<ValuedSamples> below;
        for (std::uint32_t c = 0; c < node.childCount; ++c) {
            auto child = writeSubtree(node.firstChild + c);
            if (!child) return child;
            below.push_back(std::move(*child));
        }
        points = valueInner(index, below, packed.front());
    }
    if (!points) return points;
    if (auto ok = append(packed); !ok) return passOn(ok);
    return points;
}

/// `packed`: of the subtree, children first.
Expected<ValuedSamples> MeasuredCopy::measure(std::uint32_t index, std::span<Packed> packed) {
    const Node& node = nodes_[index].node;
    if (node.isLeaf()) return measureLeaf(index, packed.back());
    std::vector<std::size_t> first{0};
    for (std::uint32_t c = 0; c < node.childCount; ++c)
        first.push_back(first.back() + subtree_[node.firstChild + c]);
    std::vector<ValuedSamples> below(node.childCount);
    std::vector<Expected<void>> done(node.childCount);
    tbb::parallel_for(std::uint32_t(0), std::uint32_t(node.childCount), [&](std::uint32_t c) {
        auto points = measure(node.firstChild + c, packed.subspan(first[c], first[c + 1] - first[c]));
        if (points)
            below[c] = std::move(*points);
        else
            done[c] = passOn(points);
    });
    for (const auto& ok : done)
        if (!ok) return passOn(ok);
    return valueInner(index, below, packed.back());
}

Expected<ValuedSamples> MeasuredCopy::measureLeaf(std::uint32_t index, Packed& packed) {
    if (stop_.stop_requested()) return fail(ErrorCode::Cancelled, "Measuring distances was abandoned");
    const auto samples = copyNode(index, packed);
    if (!samples) return passOn(samples);
    const Node& node = nodes_[index].node;
    std::vector<glm::dvec3> places(samples->size());
    if (auto ok = places_.of(index, node, *samples, places); !ok) return passOn(ok);
    packed.isLeaf = true;
    packed.values.resize(samples->size());
    if (auto ok = leafDistances(earlier_, places, options_.most, packed.values); !ok) return passOn(ok);
    packed.planes[cloud_.facts().columns.size()] =
        encodeRows(std::as_bytes(std::span(packed.values)), sizeof(float));
    meter_->add(samples->size());
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = position(node, (*samples)[i]);
    return ValuedSamples{std::move(places), packed.values};
}

Expected<ValuedSamples> MeasuredCopy::valueInner(std::uint32_t index, std::span<const ValuedSamples> below,
                                                 Packed& packed) {
    if (stop_.stop_requested()) return fail(ErrorCode::Cancelled, "Measuring distances was abandoned");
    const auto samples = copyNode(index, packed);
    if (!samples) return passOn(samples);
    std::vector<glm::dvec3> places;
    places.reserve(samples->size());
    for (const Sample& sample : *samples) places.push_back(position(nodes_[index].node, sample));
    packed.values = nearestBelow(places, below);
    packed.planes.back() = encodeRows(std::as_bytes(std::span(packed.values)), sizeof(float));
    return ValuedSamples{std::move(places), packed.values};
}

/// All that the cloud has of the node, packed again: what is damaged is found here.
Expected<std::vector<Sample>> MeasuredCopy::copyNode(std::uint32_t index, Packed& packed) const {
    packed.node = index;
    packed.planes.resize(planes_);
    auto samples = cloud_.samples(index);
    if (!samples) return samples;
    packed.samples = encodeSamples(*samples);
    for (std::size_t p = 0; p < cloud_.planes().size(); ++p) {
        const auto values = cloud_.plane(index, p);
        if (!values) return passOn(values);
        // The new column stands behind the others, before the companions.
        const std::size_t to = p < cloud_.facts().columns.size() ? p : p + 1;
        if (!values->empty()) packed.planes[to] = encodeRows(*values, bytesOf(cloud_.planes()[p].type));
    }
    return samples;
}

Expected<void> MeasuredCopy::append(std::span<Packed> packed) {
    for (Packed& one : packed) {
        const auto samples = writer_.append(one.samples);
        if (!samples) return passOn(samples);
        nodes_[one.node].samples = *samples;
        for (std::size_t p = 0; p < planes_; ++p) {
            const auto place = writer_.append(one.planes[p]);
            if (!place) return passOn(place);
            planePlaces_[one.node * planes_ + p] = *place;
        }
        if (one.isLeaf) summary_.add(one.values);
        digest_->add(std::as_bytes(std::span(one.values)));
        one = {};
    }
    return {};
}

}  // namespace scancast
