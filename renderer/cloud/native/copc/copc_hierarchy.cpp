#include "renderer/cloud/native/copc/copc_hierarchy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

namespace scancast {

namespace {

struct Page {
    std::uint64_t offset = 0, bytes = 0;
};

class Reading {
  public:
    Reading(const RandomReader& reader, const VoxelLimits& limits)
        : reader_(reader), fileBytes_(reader.size()), limits_(limits) {}

    Expected<VoxelTree> run(const CopcInfo& info) {
        // Pages of one depth are asked for together.
        std::vector<Page> pages{{info.pageOffset, info.pageBytes}};
        while (!pages.empty()) {
            pagesRead_ += pages.size();
            if (pagesRead_ > limits_.pages) return tooLarge();
            for (const Page& page : pages) {
                if (auto ok = check(page); !ok) return passOn(ok);
                reader_.expect(page.offset, page.bytes);
            }
            next_.clear();
            for (const Page& page : pages)
                if (auto ok = read(page); !ok) return passOn(ok);
            std::swap(pages, next_);
        }
        return sorted();
    }

  private:
    tl::unexpected<Error> tooLarge() const {
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("its octree has more than {} voxels or {} pages, and is not shown as it is{}",
                                limits_.entries, limits_.pages, ingestInstead));
    }

    Expected<void> check(const Page& page) {
        if (page.bytes == 0 || page.bytes % copcEntryBytes != 0 || page.offset > fileBytes_ ||
            page.bytes > fileBytes_ - page.offset)
            return fail(ErrorCode::Malformed,
                        fmt::format("a page of its octree, {} bytes at byte {}, is none, or lies outside it",
                                    page.bytes, page.offset));
        if (!seen_.insert(page.offset).second)
            return fail(ErrorCode::Malformed,
                        fmt::format("the page of its octree at byte {} is named twice", page.offset));
        entries_ += page.bytes / copcEntryBytes;
        if (entries_ > limits_.entries) return tooLarge();
        return {};
    }

    Expected<void> read(const Page& page) {
        std::vector<std::byte> bytes(std::size_t(page.bytes));
        const auto got = reader_.readAt(page.offset, bytes);
        if (!got) return passOn(got);
        if (*got < bytes.size())
            return fail(ErrorCode::Truncated,
                        fmt::format("it ends at byte {}, within a page of its octree", page.offset + *got));
        for (std::size_t at = 0; at < bytes.size(); at += copcEntryBytes) {
            const auto entry =
                decodeCopcEntry(std::span<const std::byte>(bytes).subspan(at).first<copcEntryBytes>());
            if (auto ok = take(entry, page.offset + at); !ok) return ok;
        }
        return {};
    }

    Expected<void> take(const CopcEntry& entry, std::uint64_t at) {
        const char* wrong = wrongCopcEntry(entry);
        if (!wrong && !entry.isPage() && entry.points > 0 &&
            (entry.offset > fileBytes_ || std::uint64_t(entry.bytes) > fileBytes_ - entry.offset))
            wrong = "its points lie outside the file";
        if (wrong)
            return fail(ErrorCode::Malformed,
                        fmt::format("byte {}: voxel {} of its octree: {}", at, text(entry.key), wrong));
        if (entry.isPage()) {
            next_.push_back({entry.offset, std::uint64_t(entry.bytes)});
            return {};
        }
        if (std::uint32_t(entry.points) > limits_.points || std::uint32_t(entry.bytes) > limits_.chunkBytes)
            return fail(ErrorCode::ResourceLimit,
                        fmt::format("voxel {} has {} points in {} bytes, too many to be shown as they are{}",
                                    text(entry.key), entry.points, entry.bytes, ingestInstead));
        voxels_.push_back({entry.key, entry.points > 0 ? entry.offset : 0,
                           entry.points > 0 ? std::uint32_t(entry.bytes) : 0, std::uint32_t(entry.points),
                           std::uint64_t(entry.points)});
        return {};
    }

    Expected<VoxelTree> sorted() {
        auto tree = voxelTreeOf(std::move(voxels_));
        if (!tree) return tree;
        if (auto ok = checkChunks(tree->voxels); !ok) return passOn(ok);
        return tree;
    }

    /// No two have the same bytes: points would be there twice.
    static Expected<void> checkChunks(const std::vector<Voxel>& voxels) {
        std::vector<std::pair<std::uint64_t, std::uint64_t>> chunks;
        for (const Voxel& voxel : voxels)
            if (voxel.points > 0) chunks.emplace_back(voxel.offset, voxel.bytes);
        std::ranges::sort(chunks);
        for (std::size_t i = 1; i < chunks.size(); ++i)
            if (chunks[i - 1].first + chunks[i - 1].second > chunks[i].first)
                return fail(ErrorCode::Malformed,
                            fmt::format("two voxels of its octree have the same points, at byte {}",
                                        chunks[i].first));
        return {};
    }

    const RandomReader& reader_;
    const std::uint64_t fileBytes_;
    const VoxelLimits limits_;
    std::uint64_t entries_ = 0, pagesRead_ = 0;
    std::vector<Voxel> voxels_;
    std::unordered_set<std::uint64_t> seen_;  // where pages begin
    std::vector<Page> next_;
};

}  // namespace

Expected<VoxelTree> readCopcHierarchy(const RandomReader& reader, const CopcInfo& info,
                                      const VoxelLimits& limits) {
    return Reading(reader, limits).run(info);
}

}  // namespace scancast
