// What pictures cost: the table of rates that server/price ships, measured anew; and how long the CPU device draws
// between two pauses. One thread, a generated town, 2048 x 2048, the best of several runs.
//
//     bench_prices [--points 4M]           prints the rates, as `serve --rates FILE` reads them
//     bench_prices --pauses [--threads 2]  prints the longest stretch without a pause, for each method, lit and unlit
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <functional>

#include "renderer/image/encode.hpp"
#include "renderer/method/method.hpp"
#include "tests/support/clouds/scene_clouds.hpp"

namespace {

using namespace scancast;
using Clock = std::chrono::steady_clock;

constexpr int side = 2048, frames = 2, runs = 3;
constexpr double pixels = double(side) * side;

double milliseconds(Clock::duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
}

double best(const std::function<void()>& work) {
    double least = 1e30;
    for (int i = 0; i < runs; ++i) {
        const auto start = Clock::now();
        work();
        least = std::min(least, milliseconds(Clock::now() - start));
    }
    return least;
}

struct Drawn {
    double ms = 0, samples = 0;
};

class Bench {
  public:
    Bench(std::uint64_t points, int threads) : cloud_(*test::sceneCloud("town", points)) {
        DeviceOptions options;
        options.backend = "cpu";
        options.threads = threads;
        device_ = *createDevice(options);
    }

    View view(const std::string& method) const {
        View view = defaultView(*cloud_, side, side);
        view.style.method = method;
        view.style.shading = Shading::Unlit;
        view.style.light.occlusion = 0.0;
        view.quality.samples = frames;
        return view;
    }
    /// Nothing, where the method does not go with the style.
    std::optional<Drawn> draw(const View& view, double detail) const {
        View exact = view;
        exact.quality.detail = detail;
        const auto planned = plan(*cloud_, exact);
        if (!planned) return std::nullopt;
        const auto prepared = *prepare(*cloud_, *planned);
        Drawn drawn;
        drawn.ms =
            best([&] { drawn.samples = double(scancast::draw(*device_, *prepared)->stats.samplesDrawn); });
        return drawn;
    }
    Frame frame() const { return *render(*device_, *cloud_, view("disc")); }

    /// (longest stretch, pauses), ms.
    std::optional<std::pair<double, int>> longest(const View& view) const {
        const auto planned = plan(*cloud_, view);
        if (!planned) return std::nullopt;
        const auto prepared = *prepare(*cloud_, *planned);
        std::pair<double, int> found{1e30, 0};
        for (int i = 0; i < runs; ++i) {
            double most = 0;
            int pauses = 0;
            auto last = Clock::now();
            const auto note = [&] {
                most = std::max(most, milliseconds(Clock::now() - last));
                last = Clock::now();
            };
            const Pause pause = [&] {
                note();
                ++pauses;
            };
            auto begun = *beginDrawing(*device_, *prepared, {}, Uploads::Everything, &pause);
            note();
            std::ignore = begun->finish();
            found = {std::min(found.first, most), pauses};
        }
        return found;
    }

  private:
    std::shared_ptr<const Cloud> cloud_;
    std::unique_ptr<Device> device_;
};

/// ns a pixel and frame, and ns a sample and frame, from a coarse picture and a fine one.
std::pair<double, double> ratesOf(const Drawn& coarse, const Drawn& fine) {
    const double perSample =
        std::max(0.0, (fine.ms - coarse.ms) / std::max(1.0, fine.samples - coarse.samples) / frames);
    const double perPixel = std::max(0.0, coarse.ms / frames - coarse.samples * perSample) / pixels;
    return {perPixel * 1e6, perSample * 1e6};
}

void printRates(const Bench& bench) {
    fmt::print("{{\n  \"methods\": {{\n");
    Drawn plain;
    for (const Method& method : methods()) {
        const auto coarse = bench.draw(bench.view(method.name), 6),
                   fine = bench.draw(bench.view(method.name), 0.5);
        if (!coarse || !fine) continue;
        const auto [perPixel, perSample] = ratesOf(*coarse, *fine);
        fmt::print("    \"{}\": {{\"pixel\": {:.1f}, \"sample\": {:.1f}}},\n", method.name, perPixel,
                   perSample);
        if (method.name == std::string("disc")) plain = *coarse;
    }
    fmt::print("  }},\n  \"passes\": {{\n");
    const auto beyond = [&](const char* name, const std::function<void(View&)>& change) {
        View lit = bench.view("disc");
        change(lit);
        const auto drawn = bench.draw(lit, 6);
        const double extra = drawn ? std::max(0.0, drawn->ms - plain.ms) / frames / pixels * 1e6 : 0;
        fmt::print("    \"{}\": {:.1f},\n", name, extra);
    };
    beyond("phong", [](View& view) { view.style.shading = Shading::Phong; });
    beyond("eyedome", [](View& view) { view.style.shading = Shading::EyeDome; });
    beyond("occlusion", [](View& view) { view.style.light.occlusion = 0.5; });
    beyond("shadow", [](View& view) {
        view.style.light.sun = {200.0, 40.0};
        view.style.light.shadow = 0.8;
    });
    const Frame frame = bench.frame();
    const auto encoding = [&](const std::function<void()>& work) { return best(work) / pixels * 1e6; };
    fmt::print("  }},\n  \"encoders\": {{\"jpeg\": {:.1f}, \"png\": {:.1f}}}\n}}\n",
               encoding([&] { std::ignore = encodeJpeg(frame, 90, Subsampling::S420); }),
               encoding([&] { std::ignore = encodePng(frame, false); }));
}

void printPauses(const Bench& bench) {
    fmt::print("{:<12} {:>22} {:>22}\n", "method", "unlit: longest (pauses)", "lit: longest (pauses)");
    for (const Method& method : methods()) {
        View lit = bench.view(method.name);
        lit.style.shading = Shading::Phong;
        lit.style.light.sun = {200.0, 40.0};
        lit.style.light.shadow = 0.8;
        lit.style.light.occlusion = 0.5;
        std::string line;
        for (const View& view : {bench.view(method.name), lit}) {
            const auto longest = bench.longest(view);
            line += fmt::format(
                " {:>22}", longest ? fmt::format("{:.1f} ms ({})", longest->first, longest->second) : "-");
        }
        fmt::print("{:<12}{}\n", method.name, line);
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"What pictures cost, and how long they are drawn without a pause."};
    std::uint64_t points = 4'000'000;
    int threads = 0;
    bool pauses = false;
    app.add_option("--points", points, "Of the generated town")->capture_default_str();
    app.add_option("--threads", threads, "Of the CPU device; 0 = one for rates, all for pauses");
    app.add_flag("--pauses", pauses, "Print the longest stretches without a pause");
    CLI11_PARSE(app, argc, argv);
    if (pauses)
        printPauses(Bench(points, threads));
    else
        printRates(Bench(points, threads == 0 ? 1 : threads));
}
