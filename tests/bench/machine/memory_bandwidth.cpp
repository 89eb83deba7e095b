// The memory bandwidth that this machine's cores reach together, reading: the ceiling for anything that has
// to look at every sample once. Prints one number, in GB/s (the best of several passes over 1 GiB).
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <thread>
#include <vector>

namespace {

std::uint64_t sum(const std::uint64_t* words, std::size_t count) {
    std::uint64_t lanes[8] = {};
    for (std::size_t i = 0; i + 8 <= count; i += 8) {
        for (std::size_t lane = 0; lane < 8; ++lane) lanes[lane] += words[i + lane];
    }
    std::uint64_t total = 0;
    for (const auto lane : lanes) total += lane;
    return total;
}

}  // namespace

int main() {
    const std::size_t words = (std::size_t(1) << 30) / sizeof(std::uint64_t);
    const std::vector<std::uint64_t> memory(words, 1);
    const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::uint64_t> totals(threads);
    double best = 0;
    for (int pass = 0; pass < 7; ++pass) {
        const auto start = std::chrono::steady_clock::now();
        std::vector<std::jthread> workers;
        for (std::size_t t = 0; t < threads; ++t) {
            workers.emplace_back(
                [&, t] { totals[t] = sum(memory.data() + words / threads * t, words / threads); });
        }
        workers.clear();
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        best = std::max(best, static_cast<double>(words * sizeof(std::uint64_t)) / seconds.count() / 1e9);
    }
    std::printf("%.1f\n", best);
    return totals[0] == 0;  // keeps the sums alive
}
