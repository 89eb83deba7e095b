// Pictures one after the other, each another in one thing: what the GPU was told for the one before and is not told
// again must not be seen in the next. The oracle is the cpu device, which keeps nothing, byte by byte.
#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>

#include "renderer/residency/device_memory.hpp"
#include "renderer/together/together.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

class ToldOnce : public OnDevice {
  protected:
    void SetUp() override {
        OnDevice::SetUp();
        if (!device_) return;
        REQUIRE_DEVICE(cpu, "cpu");
        cpu_ = cpu;
        DeviceOptions options;
        options.backend = GetParam();
        options.gpuMemoryLimit = 900 << 10;  // one of the clouds, not both
        auto opened = createDevice(options);
        ASSERT_TRUE(opened) << opened.error().message;
        small_ = std::move(*opened);
    }

    /// Large nodes would make one extent each; these make some hundred, in several pages.
    static std::shared_ptr<const Cloud> cloud(const std::string& scene, std::uint64_t points) {
        return sceneCloud(scene, points, 128).value();
    }
    std::shared_ptr<const Cloud> bothAt(const glm::dvec3& shift, const Cloud* like = nullptr) {
        std::vector<TogetherMember> members{{.name = "town", .cloud = town_},
                                            {.name = "statue", .cloud = statue_, .shift = shift}};
        return putTogether(std::move(members), false, cache_, like).value();
    }

    void expectSame(const char* what, const Cloud& cloud, const View& view,
                    const RenderOptions& options = {}) {
        SCOPED_TRACE(what);
        const auto expected = render(*cpu_, cloud, view, options),
                   found = render(*small_, cloud, view, options);
        ASSERT_TRUE(expected && found);
        EXPECT_TRUE(expected->rgba == found->rgba) << "colours";
        EXPECT_TRUE(expected->depth == found->depth) << "depths";
    }

    static View turned(View view, double degrees) {
        const double angle = glm::radians(degrees);
        const glm::dvec3 d = view.camera.target - view.camera.eye;
        view.camera.target = view.camera.eye + glm::dvec3(std::cos(angle) * d.x - std::sin(angle) * d.y,
                                                          std::sin(angle) * d.x + std::cos(angle) * d.y, d.z);
        return view;
    }

    Device* cpu_ = nullptr;
    std::unique_ptr<Device> small_;
    const std::shared_ptr<BlockCache> cache_ = [] {
        BlockCacheOptions options;
        options.memoryLimit = 64 << 20;
        return BlockCache::create(options);
    }();
    const std::shared_ptr<const Cloud> town_ = cloud("town", 30'000), statue_ = cloud("statue", 25'000);
};
INSTANTIATE_TEST_SUITE_P(Gl, ToldOnce, testing::Values("egl"), deviceName);

TEST_P(ToldOnce, NothingOfThePictureBeforeIsSeen) {
    View view = sceneView(*town_, sceneViews("town")[0], Projection::Perspective, 161, 113);
    const glm::dvec3 target = view.camera.target;
    for (const char* method : {"point", "paraboloid"}) {
        SCOPED_TRACE(method);
        View v = view;
        v.style.method = method;
        v.quality.detail = 1.5;
        expectSame("first", *town_, v);
        expectSame("turned a little", *town_, turned(v, 0.5));
        expectSame("and a little more", *town_, turned(v, 1));
        expectSame("turned", *town_, turned(v, 40));
        expectSame("back", *town_, v);
        if (method != std::string_view("point")) continue;
        expectSame("every point", *town_, v, {.bruteForce = true});
        expectSame("every point, turned a little", *town_, turned(v, 2), {.bruteForce = true});
        v.style.clip = ClipBox{target - glm::dvec3(20), target + glm::dvec3(20)};
        expectSame("clipped", *town_, v, {.bruteForce = true});
        v.style.clip->min.x += 11;
        expectSame("clipped elsewhere", *town_, v, {.bruteForce = true});
        v.style.clips = {HalfSpace{target, {1, 1, 0.3}}};
        expectSame("and by a plane", *town_, v, {.bruteForce = true});
        v.style.clip.reset();
        v.style.clips.clear();
        v.style.color = ColorSource::Elevation;
        expectSame("by elevation", *town_, v, {.bruteForce = true});
        v.style.color = ColorSource::Lod;
        expectSame("by level, which fade", *town_, v);
        const auto both = bothAt({0, 0, 0});
        expectSame("two clouds, which do not fit", *both, v);
        expectSame("one moved, whose samples are the same", *bothAt({-3, 7, 1}, both.get()), v);
        v.camera.projection = Projection::Orthographic;
        expectSame("without perspective", *town_, v);
    }
    EXPECT_LE(small_->memory()->bytes(), std::uint64_t{900} << 10);
}

}  // namespace
}  // namespace scancast::test
