#include "renderer/device/cpu/cpu_device.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstdlib>
#include <deque>
#include <new>
#include <string>
#include <thread>

#include "files/machine.hpp"
#include "renderer/device/cpu/picture.hpp"
#include "renderer/device/cpu/simd_level.hpp"
#include "renderer/device/host/drawing.hpp"

namespace scancast {
namespace {

constexpr int maxThreads = 1024;
/// A window of this many pixels needs about 1.5 GB with anti-aliasing.
constexpr std::int64_t maxWindowPixels = std::int64_t{1} << 26;
Expected<void> check(const Drawing& d) {
    if (auto ok = checkDrawing(d); !ok) return ok;
    const Window& w = d.window;
    if (std::int64_t{w.width} * w.height > maxWindowPixels) {
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("A window of {} x {} pixels is too large to draw at once; draw it in parts.",
                                w.width, w.height));
    }
    return {};
}

class CpuDevice final : public Device {
  public:
    CpuDevice(int threads, const cpu::SimdLevel& level, std::unique_ptr<cpu::PassReduction> reduction)
        : threads_(threads),
          level_(level),
          reduction_(std::move(reduction)),
          control_(allowThreads(threads)),
          arena_(threads) {}

    DeviceInfo info() const override {
        DeviceInfo info;
        info.name = std::string("cpu");
        info.vendor = std::string("Scancast");
        info.renderer = fmt::format("x86-64-{}, threads: {}", level_.name, threads_);
        info.version = std::string("kernels 1");
        info.identity = info.name;
        info.mirrors = true;
        info.pauses = true;
        return info;
    }

    Expected<Frame> draw(const Drawing& drawing, std::stop_token stop) override {
        if (auto ok = check(drawing); !ok) return passOn(ok);
        const auto passes = framePasses(drawing.passes);
        if (!passes) return passOn(passes);
        if (depth_ == mostWithin) {
            return fail(ErrorCode::ResourceLimit,
                        "Too many pictures are being drawn within the pauses of others.");
        }
        Drawing own = drawing;
        if (reduction_) {  // which makes the pauses, when all are at the same pass
            stop = reduction_->begin(std::move(stop), drawing.pause);
            own.pause = nullptr;
        }
        try {
            const Within within(*this);
            return cpu::Picture(own, *passes, *level_.kernels, threads_, arena_, buffers_[depth_ - 1],
                                std::move(stop))
                .draw();
        } catch (const std::bad_alloc&) {
            Error error{ErrorCode::ResourceLimit,
                        "There is not enough memory to draw this picture; ask for a smaller one.",
                        {}};
            if (reduction_) reduction_->giveUp(error);
            return tl::unexpected(std::move(error));
        }
    }

  private:
    static constexpr std::size_t mostWithin = 4;

    /// A picture, perhaps in a pause of another: it has buffers of its own.
    class Within {
      public:
        explicit Within(CpuDevice& device) : device_(device) {
            if (device.buffers_.size() == device.depth_) {
                auto& buffers = device.buffers_.emplace_back();
                buffers.together.reduction = device.reduction_.get();
                for (int i = 0; i < device.threads_; ++i)
                    buffers.tiles.push_back(std::make_unique<cpu::TileMemory>());
            }
            ++device.depth_;
        }
        ~Within() { --device_.depth_; }
        Within(const Within&) = delete;
        Within& operator=(const Within&) = delete;

      private:
        CpuDevice& device_;
    };

    /// The library starts no more threads than there are cores unless told to.
    static std::unique_ptr<tbb::global_control> allowThreads(int threads) {
        if (threads <= static_cast<int>(std::thread::hardware_concurrency())) return nullptr;
        return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                     static_cast<std::size_t>(threads));
    }

    const int threads_;
    const cpu::SimdLevel& level_;
    const std::unique_ptr<cpu::PassReduction> reduction_;
    std::unique_ptr<tbb::global_control> control_;
    tbb::task_arena arena_;
    std::deque<cpu::Buffers> buffers_;  ///< of pictures within each other's pauses
    std::size_t depth_ = 0;             ///< of those that are being drawn
};

}  // namespace

Expected<std::unique_ptr<Device>> createCpuDevice(int threads,
                                                  std::unique_ptr<cpu::PassReduction> reduction) {
    if (threads < 0 || threads > maxThreads) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("The cpu device takes 1 to {} threads, or 0 for all cores, not {}.",
                                maxThreads, threads),
                    "threads");
    }
    threads = coresOf(threads);
    const char* forced = std::getenv("SCANCAST_SIMD");
    const auto level = cpu::chooseSimdLevel(forced != nullptr ? forced : "");
    if (!level) return passOn(level);
    return std::make_unique<CpuDevice>(std::min(threads, maxThreads), **level, std::move(reduction));
}

}  // namespace scancast
