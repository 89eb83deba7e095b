#include "files/random_reader.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <string>

#include "files/folder_reader.hpp"

namespace scancast {

namespace {

class FileReader final : public RandomReader {
  public:
    explicit FileReader(InputFile file) : file_(std::move(file)) {}

    std::uint64_t size() const override {
        struct stat now {};
        return ::fstat(file_.descriptor(), &now) == 0 ? std::uint64_t(now.st_size) : file_.bytes();
    }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        return file_.readAt(offset, into);
    }

  private:
    const InputFile file_;
};

class MemoryReader final : public RandomReader {
  public:
    explicit MemoryReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::uint64_t size() const override { return bytes_.size(); }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        if (offset >= bytes_.size()) return std::size_t(0);
        const auto there =
            bytes_.subspan(offset, std::min<std::uint64_t>(into.size(), bytes_.size() - offset));
        std::copy(there.begin(), there.end(), into.begin());
        return there.size();
    }

  private:
    const std::span<const std::byte> bytes_;
};

class DiskFolder final : public FolderReader {
  public:
    explicit DiskFolder(InputFolder folder) : folder_(std::move(folder)) {}

    Expected<std::vector<std::byte>> read(const std::string& name, std::uint64_t most) const override {
        const auto file = folder_.file(name);
        if (!file) return notOpened(name, file.error().code);
        if (file->bytes() > most)
            return fail(ErrorCode::ResourceLimit, "its file " + name + " has " +
                                                      std::to_string(file->bytes()) + " bytes; " +
                                                      std::to_string(most) + " at most are read");
        std::vector<std::byte> content(std::size_t(file->bytes()));
        const auto got = file->readAt(0, content);
        if (!got) return fail(ErrorCode::Io, "its file " + name + " cannot be read");
        content.resize(*got);
        return content;
    }
    std::uint64_t bytes() const override { return folder_.bytes(); }

  private:
    /// Without the path of the folder.
    static tl::unexpected<Error> notOpened(const std::string& name, ErrorCode code) {
        if (code == ErrorCode::NotFound) return fail(code, "its file " + name + " is missing");
        if (code == ErrorCode::InvalidArgument)
            return fail(ErrorCode::Malformed, "its file " + name + " is outside its folder");
        if (code == ErrorCode::Unsupported)
            return fail(ErrorCode::Malformed, "its file " + name + " is no file");
        return fail(ErrorCode::Io, "its file " + name + " cannot be opened");
    }

    const InputFolder folder_;
};

}  // namespace

std::unique_ptr<RandomReader> readerOf(InputFile file) {
    return std::make_unique<FileReader>(std::move(file));
}

std::unique_ptr<RandomReader> readerOf(std::span<const std::byte> bytes) {
    return std::make_unique<MemoryReader>(bytes);
}

std::shared_ptr<const FolderReader> readerOf(InputFolder folder) {
    return std::make_shared<DiskFolder>(std::move(folder));
}

}  // namespace scancast
