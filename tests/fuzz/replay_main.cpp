// Runs a fuzz target without libFuzzer: every seed, its truncations, and deterministic mutations of it.
// So that each parser meets hostile bytes in every ordinary test run, under every sanitizer.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t seedBytes =
    16 * 1024;                       // longer seeds are cut: mutations matter at the front, where lengths are
constexpr int usualMutations = 400;  ///< of each seed; --mutations N for a target that takes long

void collect(const std::filesystem::path& path, std::vector<Bytes>& seeds) {
    if (std::filesystem::is_directory(path)) {
        std::vector<std::filesystem::path> entries;
        for (const auto& entry : std::filesystem::directory_iterator(path)) entries.push_back(entry.path());
        std::sort(entries.begin(), entries.end());
        for (const auto& entry : entries) collect(entry, seeds);
        return;
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        std::fprintf(stderr, "seed %s is not there: skipped\n", path.c_str());
        return;
    }
    Bytes bytes(seedBytes);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    seeds.push_back(std::move(bytes));
}

void run(const Bytes& bytes) {
    // A fresh exact-size copy, so that AddressSanitizer sees a read one byte too far.
    const Bytes copy(bytes);
    LLVMFuzzerTestOneInput(copy.data(), copy.size());
}

Bytes mutate(Bytes bytes, std::mt19937& random) {
    if (bytes.empty()) return bytes;
    const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    // Squaring favours the front of the file, where headers are.
    const auto place = [&] { return pick(pick(bytes.size()) + 1); };
    const int edits = 1 + static_cast<int>(pick(4));
    for (int i = 0; i < edits && !bytes.empty(); ++i) {
        switch (pick(5)) {
            case 0:
                bytes[place()] ^= static_cast<std::uint8_t>(1u << pick(8));
                break;
            case 1:
                bytes[place()] = static_cast<std::uint8_t>(random());
                break;
            case 2:
                bytes.resize(place());
                break;
            case 3: {  // an extreme value where a length might stand
                static constexpr std::uint8_t extremes[] = {0x00, 0xff, 0x7f, 0x80};
                const auto at = place();
                const auto value = extremes[pick(4)];
                for (std::size_t k = at; k < std::min(at + 4, bytes.size()); ++k) bytes[k] = value;
                break;
            }
            default: {
                const auto at = place();
                bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                             static_cast<std::uint8_t>(random()));
            }
        }
    }
    return bytes;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<Bytes> seeds{{}};
    int first = 1, mutations = usualMutations;
    if (argc > 2 && std::string_view(argv[1]) == "--mutations") {
        mutations = std::atoi(argv[2]);
        first = 3;
    }
    for (int i = first; i < argc; ++i) collect(argv[i], seeds);
    std::mt19937 random(1);
    std::size_t runs = 0;
    for (const auto& seed : seeds) {
        run(seed);
        for (int i = 0; i < mutations; ++i) run(mutate(seed, random));
        runs += std::size_t(1 + mutations);
    }
    std::printf("%zu inputs from %zu seeds\n", runs, seeds.size());
}
