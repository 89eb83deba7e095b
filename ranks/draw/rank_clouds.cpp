#include "ranks/draw/rank_clouds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "ranks/mpi/session.hpp"
#include "renderer/residency/node_runs.hpp"
#include "renderer/residency/open_cloud.hpp"

namespace scancast {
namespace {

std::string keyOf(const CloudPlace& place) {
    return place.path + '\0' + place.revision;
}

/// What rank 0 says of a file to open: its path and revision, then those of all that it still has; each word ends with a 0.
void addWord(RankBytes& message, const std::string& word) {
    const auto bytes = std::as_bytes(std::span(word));
    message.insert(message.end(), bytes.begin(), bytes.end());
    message.push_back(std::byte{0});
}

std::vector<std::string> wordsOf(const RankBytes& message) {
    std::vector<std::string> words(1);
    for (const std::byte byte : message) {
        if (byte == std::byte{0})
            words.emplace_back();
        else
            words.back().push_back(std::to_integer<char>(byte));
    }
    words.pop_back();
    return words;
}

}  // namespace

// ---- rank 0

std::optional<std::string> SharedClouds::openOnAll(const std::shared_ptr<const CloudPlace>& place) {
    const std::scoped_lock lock(opens_);
    if (closed_) return "the ranks are ending";
    std::erase_if(shared_, [](const auto& shared) { return shared.expired(); });
    RankBytes message;
    addWord(message, place->path);
    addWord(message, place->revision);
    for (const auto& shared : shared_) {
        const auto other = shared.lock();
        if (!other) continue;
        addWord(message, other->path);
        addWord(message, other->revision);
    }
    if (auto ok = opening_.broadcast(message); !ok) MpiSession::abortAll(ok.error().message);
    if (auto opened = opening_.agree(Expected<void>()); !opened) return opened.error().message;
    shared_.push_back(place);
    return std::nullopt;
}

std::shared_ptr<SampleStore> SharedClouds::add(std::shared_ptr<const CloudFile> file) {
    std::error_code unknown;
    const auto path = std::filesystem::absolute(file->path(), unknown);
    const std::string name = file->path().filename().string();
    std::optional<std::string> alone;
    std::shared_ptr<const CloudPlace> place;
    if (!file->facts().look) {
        alone = fmt::format("no look is kept in it; scancast look {} decides it once and keeps it",
                            file->path().string());
    } else if (unknown || !std::filesystem::exists(path, unknown)) {
        alone = "it is no file here that other ranks could open";
    } else {
        place = std::make_shared<const CloudPlace>(path.string(), file->facts().revision);
        alone = openOnAll(place);
    }
    if (!alone) return sharedStore(cache_->add(std::move(file)), share_, std::move(place));
    onAlone_(fmt::format("{}: rank 0 draws it alone: {}", name, *alone));
    return cache_->add(std::move(file));
}

void SharedClouds::know(const std::shared_ptr<const Cloud>& cloud) {
    const std::scoped_lock lock(mutex_);
    const std::uint64_t source = cloud->octree.source();
    if (const auto known = known_.find(source); known != known_.end() && known->second.cloud.lock() == cloud)
        return;
    std::erase_if(known_, [](const auto& known) { return known.second.cloud.expired(); });
    Known& known = known_[source];
    known.cloud = cloud;
    known.place.reset();
    if (const auto place = placeOfShared(cloud->octree.store())) known.place = *place;
}

Expected<std::optional<CloudPlace>> SharedClouds::placeOf(std::uint64_t source) const {
    const std::scoped_lock lock(mutex_);
    const auto known = known_.find(source);
    if (known == known_.end())
        return fail(ErrorCode::Internal,
                    "A cloud is to be drawn of which it is not known whether ranks share it.");
    return known->second.place;
}

void SharedClouds::close() {
    const std::scoped_lock lock(opens_);
    closed_ = true;
}

// ---- the others

Expected<void> OpenedClouds::open(const std::vector<std::string>& words) try {
    if (words.size() < 2 || words.size() % 2 != 0)
        return fail(ErrorCode::Internal,
                    "What a rank was told to open is no file; are all ranks of one version?");
    std::vector<std::string> kept;
    for (std::size_t i = 0; i < words.size(); i += 2) kept.push_back(keyOf({words[i], words[i + 1]}));
    {
        const std::scoped_lock lock(mutex_);
        std::erase_if(clouds_,
                      [&](const auto& cloud) { return std::ranges::find(kept, cloud.first) == kept.end(); });
    }
    auto opened = openCloud(std::filesystem::path(words[0]), cache_);
    if (!opened)
        return fail(opened.error().code,
                    fmt::format("rank {} cannot open it: {}", opening_.rank(), opened.error().message));
    if ((*opened)->revision != words[1])
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} is another file on rank {}: its revisions are {} and {}", words[0],
                                opening_.rank(), words[1], (*opened)->revision));
    const std::scoped_lock lock(mutex_);
    clouds_[kept.front()] = std::move(*opened);
    return {};
} catch (const std::exception& e) {
    return fail(ErrorCode::ResourceLimit,
                fmt::format("rank {} cannot open it: {}", opening_.rank(), e.what()));
}

void OpenedClouds::openWithFirst() try {
    for (;;) {
        RankBytes message;
        if (auto ok = opening_.broadcast(message); !ok) MpiSession::abortAll(ok.error().message);
        if (message.empty()) return;
        // What one of them cannot open, rank 0 draws alone.
        (void)opening_.agree(open(wordsOf(message)));
    }
} catch (const std::exception& e) {
    MpiSession::abortAll(fmt::format("A rank cannot open clouds with the others: {}", e.what()));
}

Expected<std::uint64_t> OpenedClouds::openOnAll(const RankBytes& words) {
    RankBytes message = words;
    const std::vector<std::string> named = wordsOf(words);
    if (named.size() < 2)
        return fail(ErrorCode::Internal, "What ranks were told to open is no file; are all of one version?");
    if (auto ok = opening_.broadcast(message); !ok) MpiSession::abortAll(ok.error().message);
    if (auto opened = opening_.agree(open(named)); !opened) return passOn(opened);
    const auto cloud = find({named[0], named[1]});
    if (!cloud) return passOn(cloud);
    return (*cloud)->octree.store().capacity() * share_.of;
}

Expected<std::shared_ptr<const Cloud>> OpenedClouds::find(const CloudPlace& place) {
    const std::scoped_lock lock(mutex_);
    if (const auto known = clouds_.find(keyOf(place)); known != clouds_.end()) return known->second;
    return fail(ErrorCode::InvalidArgument, fmt::format("{} is not open on all ranks.", place.path));
}

Expected<void> OpenedClouds::provide(UnpackedDrawing& drawing) {
    const auto cloud = find(drawing.cloud);
    if (!cloud) return passOn(cloud);
    const Octree& octree = (*cloud)->octree;
    if (auto ok = drawing.findNodes(octree); !ok) return ok;
    std::vector<std::uint32_t> own;
    for (const CutView* const view : drawing.allCuts())
        for (const CutRun& run : view->cut.runs)
            if (share_.has(run.nodeIndex)) own.push_back(run.nodeIndex);
    NodeRuns runs(octree);
    if (auto ok = runs.load(own, {}); !ok) return ok;
    for (CutView* const view : drawing.allCuts()) {
        for (CutRun& run : view->cut.runs) {
            if (!share_.has(run.nodeIndex)) continue;
            if (!runs.has(run.nodeIndex))
                return fail(
                    ErrorCode::Malformed,
                    fmt::format("{}: a rank cannot read block {}; scancast info --verify tells which blocks "
                                "are damaged.",
                                drawing.cloud.path, run.nodeIndex));
            const SampleRun& samples = runs.run(run.nodeIndex);
            run.samples = samples.samples;
            run.limits = samples.limits;
            if (view->cut.beside) run.beside = samples.beside;
            if (samples.keep) view->cut.keep.push_back(samples.keep);
        }
    }
    return {};
}

Expected<std::unique_ptr<UnpackedDrawing>> OpenedClouds::unpack(std::span<const std::byte> bytes) {
    try {
        auto drawing = unpackDrawing(bytes);
        if (!drawing) return drawing;
        if (auto provided = provide(**drawing); !provided) return passOn(provided);
        return drawing;
    } catch (const std::exception& e) {
        return fail(ErrorCode::ResourceLimit, fmt::format("Rank {} cannot draw its share of this picture: {}",
                                                          opening_.rank(), e.what()));
    }
}

}  // namespace scancast
