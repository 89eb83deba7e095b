// A cloud file without a file: a tree of any shape whose blocks are made up, arrive as slowly as the test
// likes, and are damaged where it says so. *Thread safety*: as a real one's; the settings, too, may change at
// any time.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "renderer/cloud/curvature.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

class FakeCloudFile final : public CloudFile {
  public:
    /// Breadth first, up to 8 children a node, `levels` levels at most, samplesPerNode each. Deterministic.
    FakeCloudFile(std::uint64_t seed, int levels, std::uint32_t samplesPerNode, double childChance = 0.8) {
        Node root = make(samplesPerNode, 0, noNode);
        stored_.push_back({root, {}});
        for (std::size_t at = 0; at < stored_.size(); ++at) {
            const int level = stored_[at].node.level;
            if (level + 1 >= levels || (at > 0 && uniform(at, seed) > childChance)) continue;
            const int children = 2 + int(uniform(at, seed + 1) * 6);
            stored_[at].node.firstChild = std::uint32_t(stored_.size());
            stored_[at].node.childCount = std::uint8_t(children);
            for (int c = 0; c < children; ++c)
                stored_.push_back({make(samplesPerNode, level + 1, std::uint32_t(at)), {}});
        }
        for (StoredNode& stored : stored_)
            stored.node.firstSample = facts_.points, facts_.points += samplesPerNode;
    }

    const std::filesystem::path& path() const override { return path_; }
    std::uint64_t bytes() const override { return 0; }
    bool isRemote() const override { return remote_; }
    bool isAway() const override { return away_; }
    /// Before anybody opens it: it comes over a network.
    void beRemote() { remote_ = true; }
    void setAway(bool away) { away_ = away; }
    const CloudFacts& facts() const override { return facts_; }
    std::span<const StoredNode> nodes() const override { return stored_; }
    std::span<const ValuePlane> planes() const override { return planes_; }
    /// Of every third node none.
    Expected<std::vector<std::byte>> plane(std::uint32_t node, std::size_t index) const override {
        const std::lock_guard lock(mutex_);
        if (damagedCurvatures_.contains(node))
            return fail(ErrorCode::Malformed, "node " + std::to_string(node) + " at byte 4712 is damaged");
        if (node % 3 == 2) return std::vector<std::byte>();
        if (planes_[index] == nearInfraredPlane())
            return std::vector<std::byte>(stored_[node].node.sampleCount, std::byte(infraredOf(node)));
        const std::vector<CurvatureCode> codes(stored_[node].node.sampleCount, node + 1);
        const auto bytes = std::as_bytes(std::span(codes));
        return std::vector<std::byte>(bytes.begin(), bytes.end());
    }
    /// Before anybody opens it: samples get curvatures that tell whose they are.
    void addCurvatures() { planes_.push_back(curvaturePlane()); }
    void addNearInfrared() { planes_.push_back(nearInfraredPlane()); }
    static std::uint8_t infraredOf(std::uint32_t node) { return std::uint8_t(200 - node % 100); }
    void damageCurvatures(std::uint32_t node) {
        set([&] { damagedCurvatures_.insert(node); });
    }
    BlockPlace planePlace(std::uint32_t, std::size_t) const override { return {}; }
    Expected<std::vector<std::byte>> rows(std::uint32_t) const override { return std::vector<std::byte>(); }

    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        std::unique_lock lock(mutex_);
        ++readers_;
        mostReaders_ = std::max(mostReaders_, readers_);
        changed_.notify_all();
        changed_.wait(lock, [&] { return open_; });
        const auto delay = delay_;
        lock.unlock();
        if (delay.count() > 0) std::this_thread::sleep_for(delay);
        lock.lock();
        --readers_;
        reads_.push_back(node);
        changed_.notify_all();
        if (damaged_.contains(node))
            return fail(ErrorCode::Malformed, "node " + std::to_string(node) + " at byte 4711 is damaged");
        // Every sample tells whose it is.
        std::vector<Sample> run(stored_[node].node.sampleCount);
        for (Sample& s : run) s.x = std::uint16_t(node), s.y = std::uint16_t(node >> 16);
        return run;
    }

    void setDelay(std::chrono::microseconds delay) {
        set([&] { delay_ = delay; });
    }
    void damage(std::uint32_t node) {
        set([&] { damaged_.insert(node); });
    }
    /// Closed: reads begin and do not end.
    void setOpen(bool open) {
        set([&] { open_ = open; });
    }
    std::vector<std::uint32_t> reads() const {
        const std::lock_guard lock(mutex_);
        return reads_;
    }
    int mostReaders() const {
        const std::lock_guard lock(mutex_);
        return mostReaders_;
    }
    /// Waits until `count` reads have ended, or are under way with `begun`; false = it took too long.
    bool waitReads(std::size_t count, bool begun = false) const {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(20), [&] {
            return reads_.size() + (begun ? std::size_t(readers_) : 0) >= count;
        });
    }

  private:
    static Node make(std::uint32_t samples, int level, std::uint32_t parent) {
        Node node{};
        node.step = glm::dvec3(1);
        node.radius = node.spacing = node.meanSpacing = float(1.0 / double(1 << level));
        node.parent = parent;
        node.level = std::uint8_t(level);
        node.sampleCount = samples;
        node.points = samples;
        return node;
    }
    template <class Change>
    void set(Change change) {
        const std::lock_guard lock(mutex_);
        change();
        changed_.notify_all();
    }

    std::filesystem::path path_ = "fake.scan";
    CloudFacts facts_;
    std::vector<StoredNode> stored_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    mutable std::vector<std::uint32_t> reads_;
    mutable int readers_ = 0, mostReaders_ = 0;
    std::chrono::microseconds delay_{0};
    std::set<std::uint32_t> damaged_, damagedCurvatures_;
    std::vector<ValuePlane> planes_;
    bool open_ = true, remote_ = false;
    std::atomic<bool> away_{false};
};

inline Octree octreeOf(const CloudFile& file, std::shared_ptr<SampleStore> store) {
    std::vector<Node> nodes;
    for (const StoredNode& stored : file.nodes()) nodes.push_back(stored.node);
    return Octree(std::move(nodes), std::move(store));
}

}  // namespace scancast::test
