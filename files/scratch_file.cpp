#include "files/scratch_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <utility>

#include "files/raw_writes.hpp"
#include "files/system_error.hpp"
#include "files/uninterrupted.hpp"

namespace scancast {

ScratchFile::ScratchFile(UniqueFd fd, std::filesystem::path folder, std::string chosenWith)
    : fd_(std::move(fd)), folder_(std::move(folder)), chosenWith_(std::move(chosenWith)) {}

Expected<std::unique_ptr<ScratchFile>> ScratchFile::create(const std::filesystem::path& folder,
                                                           std::string chosenWith) {
    std::string name = (folder / ".scancast-XXXXXX").string();
    const std::size_t stem = name.size() - 6;
    UniqueFd fd(uninterrupted([&] {
        name.replace(stem, 6, "XXXXXX");  // a call that failed may have put other letters there
        return ::mkostemp(name.data(), O_CLOEXEC);
    }));
    const int refused = fd ? 0 : errno;
    std::unique_ptr<ScratchFile> file(new ScratchFile(std::move(fd), folder, std::move(chosenWith)));
    if (refused != 0) return tl::unexpected(file->error(refused, "made"));
    ::unlink(name.c_str());
    return file;
}

std::uint64_t ScratchFile::wholePages(std::uint64_t bytes) {
    constexpr std::uint64_t page = 4096;
    return (bytes + page - 1) / page * page;
}

std::uint64_t ScratchFile::reserve(std::uint64_t bytes) {
    return end_.fetch_add(wholePages(bytes));
}

Expected<void> ScratchFile::write(std::uint64_t at, std::span<const std::byte> from) const {
    if (const int refused = writeFullyAt(fd_.get(), at, from))
        return tl::unexpected(error(refused, "written"));
    return {};
}

Expected<void> ScratchFile::read(std::uint64_t at, std::span<std::byte> into) const {
    while (!into.empty()) {
        const auto done = ::pread(fd_.get(), into.data(), into.size(), static_cast<off_t>(at));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) return tl::unexpected(error(done < 0 ? errno : EIO, "read"));
        into = into.subspan(static_cast<std::size_t>(done));
        at += static_cast<std::uint64_t>(done);
    }
    return {};
}

void ScratchFile::release(std::uint64_t at, std::uint64_t bytes) const {
    (void)::fallocate(fd_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(at),
                      static_cast<off_t>(wholePages(bytes)));
}

Error ScratchFile::error(int number, const char* what) const {
    if (isFull(number))
        return {ErrorCode::ResourceLimit,
                "There is no more room in the temporary folder " + folder_.string() + " (" +
                    systemReason(number) + "); " + wayOutOfFull(number) + " with " + chosenWith_ + ".",
                {}};
    return {
        ErrorCode::Io,
        "A temporary file in " + folder_.string() + " cannot be " + what + ": " + systemReason(number) + ".",
        {}};
}

}  // namespace scancast
