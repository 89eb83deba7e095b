#include "files/random_reader.hpp"

#include <sys/stat.h>

#include <algorithm>

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

}  // namespace

std::unique_ptr<RandomReader> readerOf(InputFile file) {
    return std::make_unique<FileReader>(std::move(file));
}

std::unique_ptr<RandomReader> readerOf(std::span<const std::byte> bytes) {
    return std::make_unique<MemoryReader>(bytes);
}

}  // namespace scancast
