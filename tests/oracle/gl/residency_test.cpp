// Samples that come and go on the GPU, seen from the front door: whatever there is room for, and however
// little a frame may upload, the pictures are those of a GPU with room for everything. The oracle is the same
// device with its usual limits, compared byte by byte.
#include <gtest/gtest.h>

#include "renderer/method/automatic.hpp"
#include "renderer/method/method.hpp"
#include "renderer/residency/device_memory.hpp"
#include "tests/support/clouds/scene_clouds.hpp"
#include "tests/support/pictures/devices.hpp"

namespace scancast::test {
namespace {

constexpr int residentWidth = 203, residentHeight = 151;
constexpr std::uint64_t kib = 1024;

const Cloud& residentCloud(const std::string& scene) {
    static std::map<std::string, std::shared_ptr<const Cloud>> clouds;
    auto& cloud = clouds[scene];
    if (!cloud) cloud = sceneCloud(scene, 50'000).value();
    return *cloud;
}

View viewOf(const std::string& scene, std::size_t number = 0) {
    const auto views = sceneViews(scene);
    View view = sceneView(residentCloud(scene), views[number % views.size()], Projection::Perspective,
                          residentWidth, residentHeight);
    view.quality.samples = 2;
    return view;
}

class Residency : public OnDevice {
  protected:
    /// A device of the same kind with less memory, or less patience.
    std::unique_ptr<Device> another(std::uint64_t memoryLimit, std::uint64_t uploadBudget = 0) const {
        DeviceOptions options;
        options.backend = GetParam();
        options.gpuMemoryLimit = memoryLimit;
        options.uploadBudget = uploadBudget;
        auto device = createDevice(options);
        EXPECT_TRUE(device) << device.error().message;
        return std::move(*device);
    }
    static Frame drawn(Device& device, const std::string& scene, const View& view,
                       const RenderOptions& options = {}) {
        auto frame = render(device, residentCloud(scene), view, options);
        EXPECT_TRUE(frame) << frame.error().message;
        return std::move(*frame);
    }
    static void expectSame(const Frame& a, const Frame& b) {
        EXPECT_EQ(a.stats.samplesDrawn, b.stats.samplesDrawn);
        EXPECT_TRUE(a.rgba == b.rgba && a.depth == b.depth);
    }
};
INSTANTIATE_TEST_SUITE_P(Gl, Residency, testing::Values("egl"), deviceName);

TEST_P(Residency, ACutThatDoesNotFitIsDrawnAllTheSame) {
    const auto tiny = another(100 * kib);
    for (const Method& method : methods()) {
        if (method.name == automaticName) continue;
        SCOPED_TRACE(method.name);
        View view = viewOf("town");
        view.style.method = method.name;
        const Frame expected = drawn(*device_, "town", view);
        const Frame frame = drawn(*tiny, "town", view);
        expectSame(frame, expected);
        EXPECT_GT(frame.stats.samplesDrawn * sizeof(Sample), 200 * kib);
        EXPECT_GT(frame.stats.bytesUploaded, frame.stats.samplesDrawn * sizeof(Sample))
            << "some of it travelled more than once";
        EXPECT_LE(tiny->memory()->bytes(), 100 * kib);
    }
}

TEST_P(Residency, MirrorsShareALittleRoomWithTheirPicture) {
    const auto tiny = another(100 * kib);
    const View view = viewOf("room");
    const Frame frame = drawn(*tiny, "room", view);
    EXPECT_GT(frame.stats.mirrorsDrawn, 0u);
    expectSame(frame, drawn(*device_, "room", view));
}

TEST_P(Residency, TheSecondPictureOfAViewUploadsNothing) {
    const auto device = another(0);
    const View view = viewOf("town");
    const Frame first = drawn(*device, "town", view);
    EXPECT_GT(first.stats.bytesUploaded, 0u);
    EXPECT_LE(first.stats.bytesUploaded, first.stats.samplesDrawn * sizeof(Sample));
    const Frame second = drawn(*device, "town", view);
    EXPECT_EQ(second.stats.bytesUploaded, 0u);
    expectSame(first, second);
}

TEST_P(Residency, CloudsTakeTurns) {
    const Frame town = drawn(*device_, "town", viewOf("town")),
                statue = drawn(*device_, "statue", viewOf("statue"));
    const std::uint64_t larger =
        std::max(town.stats.samplesDrawn, statue.stats.samplesDrawn) * sizeof(Sample);
    const auto device = another(larger * 5 / 4);
    for (int i = 0; i < 3; ++i) {
        expectSame(drawn(*device, "town", viewOf("town")), town);
        expectSame(drawn(*device, "statue", viewOf("statue")), statue);
    }
}

/// Each picture of a view that rests has a budget more than the one before, and the last is the full one.
TEST_P(Residency, MovingFramesGetWholeWithinTheirBudget) {
    constexpr std::uint64_t budget = 150 * kib;
    const auto device = another(0, budget);
    for (std::size_t number = 0; number < 2; ++number) {
        const View view = viewOf("town", number);
        const Frame expected = drawn(*device_, "town", view);
        const std::uint64_t all = expected.stats.samplesDrawn * sizeof(Sample);
        ASSERT_GT(all, 3 * budget);
        // Ancestors are less than half as many as what they stand in for.
        const std::uint64_t most = 2 + 3 * all / 2 / (budget / 2);
        std::uint64_t missing = expected.stats.samplesDrawn + 1, frames = 0;
        while (missing > 0) {
            const Frame frame = drawn(*device, "town", view, {.wait = false});
            // A node or two more than the budget: the root, and one that nothing else would let in.
            EXPECT_LE(frame.stats.bytesUploaded, budget + 2 * 16384 * sizeof(Sample));
            ASSERT_LE(frame.stats.samplesMissing, missing);
            missing = frame.stats.samplesMissing;
            ASSERT_LE(++frames, most);
            if (missing == 0) expectSame(frame, expected);
        }
        if (number == 0) {
            EXPECT_GT(frames, 2u);
        }
    }
}

TEST_P(Residency, CompletePicturesWaitForNoBudget) {
    const auto device = another(0, 20 * kib);
    const View view = viewOf("town");
    const Frame frame = drawn(*device, "town", view);
    EXPECT_EQ(frame.stats.samplesMissing, 0u);
    expectSame(frame, drawn(*device_, "town", view));
}

/// What a moving frame would draw, and there is not room for, is coarser instead: it is whole all the same.
TEST_P(Residency, MovingFramesFitTheMemory) {
    const auto device = another(200 * kib);
    const View view = viewOf("town");
    const Frame full = drawn(*device_, "town", view);
    ASSERT_GT(full.stats.samplesDrawn * sizeof(Sample), 400 * kib);
    for (int i = 0; i < 3; ++i) {
        const Frame frame = drawn(*device, "town", view, {.wait = false});
        EXPECT_LE(frame.stats.samplesDrawn * sizeof(Sample), 200 * kib);
        EXPECT_EQ(frame.stats.samplesMissing, 0u);
        if (i > 0) {
            EXPECT_EQ(frame.stats.bytesUploaded, 0u);
        }
    }
    expectSame(drawn(*device, "town", view), full);
}

}  // namespace
}  // namespace scancast::test
