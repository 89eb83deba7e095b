#include "renderer/cloud/file/change_facts.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "files/input_file.hpp"
#include "files/raw_writes.hpp"
#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

/// A cloud file under this run's lock, which ends with it.
struct LockedFile {
    InputFile file;
    CloudFileHeader header;
};

Expected<UniqueFd> openToChange(const fs::path& path) {
    UniqueFd fd(uninterrupted([&] { return ::open(path.c_str(), (inputFlags & ~O_ACCMODE) | O_RDWR); }));
    if (fd) return fd;
    if (errno == EISDIR) return fail(ErrorCode::Unsupported, path.string() + " is a folder, not a file");
    return failedToOpen(path, errno);
}

Expected<void> lock(int fd, const fs::path& path) {
    if (const int refused = lockNow(fd)) {
        if (refused == EWOULDBLOCK)
            return fail(
                ErrorCode::InvalidArgument,
                path.string() + ": somebody else is changing this file; try again when they are done");
        return fail(ErrorCode::Io,
                    fmt::format("{}: cannot be locked: {}", path.string(), systemReason(refused)));
    }
    if (isStillNamed(fd, path)) return {};
    return fail(ErrorCode::InvalidArgument,
                path.string() + ": another file has just taken this name; try again with that one");
}

Expected<CloudFileHeader> headerOf(const InputFile& file) {
    std::array<std::byte, cloudHeaderBytes> start;
    const auto got = file.readAt(0, start);
    if (!got) return passOn(got);
    auto header = parseHeader(std::span(start).first(*got), file.bytes());
    if (!header) return fail(header.error().code, file.name().string() + ", " + header.error().message);
    if (header->version == 1)
        return fail(
            ErrorCode::Unsupported,
            file.name().string() +
                ": this cloud file has version 1, whose description cannot be changed; ingest the scan "
                "again, for example: scancast ingest scan.las -o cloud.scan");
    return header;
}

Expected<LockedFile> openAndLock(const fs::path& path) {
    auto fd = openToChange(path);
    if (!fd) return passOn(fd);
    if (auto ok = lock(fd->get(), path); !ok) return passOn(ok);
    auto file = InputFile::adopt(std::move(*fd), path);
    if (!file) return passOn(file);
    const auto header = headerOf(*file);
    if (!header) return passOn(header);
    return LockedFile{std::move(*file), *header};
}

/// The new facts as text; `old` says who wrote the file.
Expected<std::string> newFacts(const CloudFile& old, const CloudFacts& facts) {
    const auto refuse = [&](ErrorCode code, const std::string& why) {
        return fail(code, fmt::format("{}: its description was not changed: {}", old.path().string(), why));
    };
    if (facts.points != old.facts().points || planesOf(facts) != planesOf(old.facts()) ||
        !std::ranges::equal(facts.photos, old.facts().photos, sameDescription))
        return refuse(ErrorCode::InvalidArgument,
                      "the new one is of another cloud, with other points, columns, companions or photos");
    auto json = printFacts(facts, old.writtenBy(), old.photoPlaces());
    if (!json) return refuse(json.error().code, json.error().message);
    return json;
}

tl::unexpected<Error> failedToChange(const fs::path& path, int error) {
    if (isFull(error))
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("{}: there is no room to change its description ({}); {}. It is as it was",
                                path.string(), systemReason(error), wayOutOfFull(error)));
    return fail(ErrorCode::Io,
                fmt::format("{}: its description cannot be changed: {}", path.string(), systemReason(error)));
}

/// The facts are on disk before the header says so.
int writeFacts(int fd, std::span<const std::byte> text, const CloudFileHeader& header) {
    if (const int refused = writeFullyAt(fd, header.facts.offset, text)) return refused;
    if (const int refused = syncFile(fd)) return refused;
    if (const int refused = writeFullyAt(fd, 0, encodeHeader(header))) return refused;
    return syncFile(fd);
}

}  // namespace

Expected<void> rewriteFacts(const fs::path& path, const CloudFacts& facts) {
    return changeFacts(path, [&](CloudFacts& changed) {
        changed = facts;
        return Expected<void>();
    });
}

Expected<void> changeFacts(const fs::path& path, const std::function<Expected<void>(CloudFacts&)>& change) {
    auto locked = openAndLock(path);
    if (!locked) return passOn(locked);
    auto shared = locked->file.share();
    if (!shared) return passOn(shared);
    const auto old = CloudFile::open(std::move(*shared));
    if (!old) return passOn(old);
    CloudFacts facts = (*old)->facts();
    if (auto changed = change(facts); !changed) return changed;
    const auto json = newFacts(**old, facts);
    if (!json) return passOn(json);

    const auto text = std::as_bytes(std::span(*json));
    CloudFileHeader header = locked->header;
    header.facts = {.offset = header.fileBytes, .bytes = text.size(), .checksum = checksumOf(text)};
    header.fileBytes = header.facts.end();
    if (const int refused = writeFacts(locked->file.descriptor(), text, header))
        return failedToChange(path, refused);
    return {};
}

}  // namespace scancast
