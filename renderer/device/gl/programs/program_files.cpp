#include "renderer/device/gl/programs/program_files.hpp"

#include <spdlog/spdlog.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "files/input_file.hpp"
#include "files/output_file.hpp"

namespace scancast::gl {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view magic = "SCGLPROG";
constexpr std::uint32_t fileVersion = 1;
constexpr std::string_view extension = ".program";
/// Programs take kilobytes; what claims to be larger is none of ours.
constexpr std::uint64_t largestFile = std::uint64_t{16} << 20;

/// Appends to a file's bytes.
struct Writer {
    std::vector<std::byte>& out;

    template <class T>
    void number(T value) {
        bytes(std::as_bytes(std::span(&value, 1)));
    }
    void bytes(std::span<const std::byte> more) { out.insert(out.end(), more.begin(), more.end()); }
    void block(std::span<const std::byte> more) {
        number(static_cast<std::uint32_t>(more.size()));
        bytes(more);
    }
    void text(std::string_view words) { block(std::as_bytes(std::span(words))); }
};

/// Takes off a file's front; what would reach beyond its end makes it `short_`, and gives nothing.
struct Reader {
    std::span<const std::byte> rest;
    bool isShort = false;

    std::span<const std::byte> bytes(std::size_t count) {
        isShort |= count > rest.size();
        if (isShort) return {};
        const auto taken = rest.first(count);
        rest = rest.subspan(count);
        return taken;
    }
    template <class T>
    T number() {
        T value{};
        const auto taken = bytes(sizeof value);
        if (!taken.empty()) std::memcpy(&value, taken.data(), sizeof value);
        return value;
    }
    std::span<const std::byte> block() { return bytes(number<std::uint32_t>()); }
    std::string_view text() {
        const auto taken = block();
        return {reinterpret_cast<const char*>(taken.data()), taken.size()};
    }
};

std::uint64_t checksumOf(std::span<const std::byte> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace

ProgramKey ProgramKey::of(std::string_view source, std::string driver) {
    const std::string all = driver + '\0' + std::string(source);
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits(all.data(), all.size()));
    ProgramKey key{std::move(driver), {}};
    constexpr std::string_view digits = "0123456789abcdef";
    for (const unsigned char byte : canonical.digest) {
        key.digest += digits[byte >> 4];
        key.digest += digits[byte & 15];
    }
    return key;
}

std::vector<std::byte> printProgramFile(const ProgramKey& key, const ProgramBinary& binary) {
    std::vector<std::byte> content, file;
    Writer inside{content};
    inside.number(binary.format);
    inside.text(key.digest);
    inside.text(key.driver);
    inside.block(binary.bytes);
    Writer put{file};
    put.bytes(std::as_bytes(std::span(magic)));
    put.number(fileVersion);
    put.number(checksumOf(content));
    put.bytes(content);
    return file;
}

Expected<ProgramBinary> parseProgramFile(std::span<const std::byte> file, const ProgramKey& key) {
    Reader take{file};
    const auto start = take.bytes(magic.size());
    if (take.isShort || std::memcmp(start.data(), magic.data(), magic.size()) != 0)
        return fail(ErrorCode::Malformed, "it is no program file");
    const auto version = take.number<std::uint32_t>();
    const auto checksum = take.number<std::uint64_t>();
    if (take.isShort) return fail(ErrorCode::Truncated, "it ends within its header");
    if (version != fileVersion) return fail(ErrorCode::Unsupported, "it is of another version");
    if (checksum != checksumOf(take.rest)) return fail(ErrorCode::Malformed, "its checksum is wrong");
    ProgramBinary binary;
    binary.format = take.number<std::uint32_t>();
    const std::string_view digest = take.text(), driver = take.text();
    const auto bytes = take.block();
    if (take.isShort || !take.rest.empty()) return fail(ErrorCode::Malformed, "its lengths do not add up");
    if (digest != key.digest || driver != key.driver)
        return fail(ErrorCode::Unsupported, "it is another program's or another driver's");
    binary.bytes.assign(bytes.begin(), bytes.end());
    return binary;
}

fs::path ProgramFiles::pathOf(const ProgramKey& key) const {
    return folder_ / (key.digest + std::string(extension));
}

std::optional<ProgramBinary> ProgramFiles::read(const ProgramKey& key) const {
    const fs::path path = pathOf(key);
    const auto bytes = readTextFile(path, largestFile);
    if (!bytes && bytes.error().code == ErrorCode::NotFound) return std::nullopt;
    auto binary =
        bytes ? parseProgramFile(std::as_bytes(std::span(*bytes)), key) : tl::unexpected(bytes.error());
    if (binary) return std::move(*binary);
    spdlog::debug("The compiled program {} is not used: {}.", path.string(), binary.error().message);
    return std::nullopt;
}

void ProgramFiles::write(const ProgramKey& key, const ProgramBinary& binary) const {
    const fs::path path = pathOf(key);
    std::error_code error;
    fs::create_directories(folder_, error);
    const auto bytes = printProgramFile(key, binary);
    if (bytes.size() > std::min(largestFile, mostBytes_)) return;
    if (const auto done = writeWholeFile(path.string(), bytes, Readers::OwnerAlone); !done) {
        spdlog::debug("The compiled program is not kept: {}", done.error().message);
        return;
    }
    removeOldest();
}

void ProgramFiles::removeOldest() const {
    sweepUnfinished(folder_,
                    [](std::string_view name) { return name.find(extension) != std::string_view::npos; });
    struct Kept {
        fs::path path;
        fs::file_time_type written;
        std::uint64_t bytes;
    };
    std::vector<Kept> files;
    std::uint64_t all = 0;
    std::error_code error;
    for (fs::directory_iterator i(folder_, error), end; !error && i != end; i.increment(error)) {
        std::error_code gone;  // another process may be at it, too
        // Those that others write at this moment count, too.
        if (i->path().filename().string().find(extension) == std::string::npos) continue;
        if (!i->is_regular_file(gone)) continue;
        Kept file{i->path(), i->last_write_time(gone), i->file_size(gone)};
        if (gone) continue;
        all += file.bytes;
        files.push_back(std::move(file));
    }
    std::ranges::sort(files, {}, &Kept::written);
    for (const Kept& file : files) {
        if (all <= mostBytes_) return;
        fs::remove(file.path, error);
        all -= file.bytes;
    }
}

}  // namespace scancast::gl
