// The sample cache as residency sees it: what may be asked between pictures, when no context is current.
// Owned by the GL device, on its thread.
#pragma once

#include "renderer/device/gl/context/gl_context.hpp"
#include "renderer/device/gl/memory/sample_cache.hpp"
#include "renderer/residency/device_memory.hpp"

namespace scancast::gl {

class GlMemory final : public DeviceMemory {
  public:
    /// `uploadBudget`: bytes a frame. Context and cache outlive it.
    GlMemory(Context& context, SampleCache& cache, std::uint64_t uploadBudget)
        : context_(context), cache_(cache), uploadBudget_(uploadBudget), capacity_(cache.capacity()) {}

    std::uint64_t capacity() const override { return capacity_; }
    std::uint64_t frameBudget() const override { return uploadBudget_ / sizeof(Sample); }
    std::uint64_t bytes() const override { return cache_.bytes(); }
    bool has(std::uint64_t source, std::uint32_t node, std::uint32_t samples, bool beside) const override {
        return cache_.has(source, node, samples, beside);
    }
    Expected<void> bring(std::uint64_t source, std::span<const CutRun> runs,
                         const std::stop_token& stop) override {
        const auto current = Context::Current::enter(context_);
        if (!current) return passOn(current);
        return cache_.bring(source, runs, stop);
    }

  private:
    Context& context_;
    SampleCache& cache_;
    const std::uint64_t uploadBudget_, capacity_;
};

}  // namespace scancast::gl
