// Prices: what they depend on, what is nearest, and how much may be asked for at a time.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "server/price/admission.hpp"
#include "tests/support/clouds/scene_clouds.hpp"

namespace scancast {
namespace {

std::shared_ptr<const Cloud> town() {
    static const std::shared_ptr<const Cloud> cloud = *test::sceneCloud("town", 50'000);
    return cloud;
}

View viewOf(int width = 1280, int height = 720) {
    View view = defaultView(*town(), width, height);
    view.style.method = "ewa";
    return view;
}

double priceOf(const View& view, PictureFormat format = PictureFormat::Jpeg,
               const Rates& rates = shippedRates()) {
    return scancast::priceOf(rates, *town(), **plan(*town(), view), format);
}

Problem refusal(const Admission& admission, const View& view, PictureFormat format = PictureFormat::Jpeg) {
    const auto price = admission.price(*town(), **plan(*town(), view), format);
    return price ? Problem() : price.error();
}

/// The view with the words changed.
View with(View view, const std::map<std::string, double>& words) {
    for (const auto& [word, value] : words) {
        if (word == "samples") view.quality.samples = int(value);
        if (word == "detail") view.quality.detail = value;
        if (word == "width") view.width = int(value);
        if (word == "height") view.height = int(value);
    }
    return view;
}

TEST(Price, GrowsWithEverythingThatTakesTime) {
    const View usual = viewOf();
    const auto more = [&](const auto& change) {
        View view = usual;
        change(view);
        return priceOf(view);
    };
    const double price = priceOf(usual);
    EXPECT_GT(price, 0);
    EXPECT_GT(more([](View& v) { v.width *= 2; }), price);
    EXPECT_GT(more([](View& v) { v.quality.samples = 5; }), price);
    EXPECT_LT(more([](View& v) { v.quality.detail = 20; }), price);
    EXPECT_LT(more([](View& v) { v.quality.budget = 100; }), price);
    EXPECT_LT(more([](View& v) { v.style.method = "point"; }), price);
    EXPECT_GT(more([](View& v) { v.style.light.occlusion = 0.5; }), price);
    EXPECT_GT(priceOf(usual, PictureFormat::Png), price);
    EXPECT_LT(priceOf(usual, PictureFormat::Depth), price) << "one sample a pixel, whatever is asked for";
}

TEST(Price, IsTheTablesSum) {
    Rates rates;
    rates.methods["ewa"] = {2, 0};
    rates.encoders["png"] = 10;
    View view = viewOf(1000, 500);
    view.quality.samples = 3;
    view.style.shading = Shading::Unlit;
    EXPECT_DOUBLE_EQ(priceOf(view, PictureFormat::Png, rates), 500'000 * (3 * 2 + 10) * 1e-6);
    rates.methods["ewa"] = {0, 7};
    const auto planned = *plan(*town(), view);
    EXPECT_DOUBLE_EQ(priceOf(view, PictureFormat::Jpeg, rates),
                     3 * 7 * 1e-6 * double(samplesWanted(*town(), *planned)));
}

TEST(Price, IsNeverMoreThanWhatIsKnownWithoutSelecting) {
    for (const double detail : {0.01, 1.0, 5.0}) {
        View view = viewOf();
        view.quality.detail = detail;
        const auto planned = *plan(*town(), view);
        EXPECT_GE(mostPriceOf(shippedRates(), *town(), *planned, PictureFormat::Jpeg), priceOf(view))
            << detail;
    }
}

TEST(Price, OfWhatIsOrdinaryIsWithinTheLimit) {
    for (const auto& [method, rate] : shippedRates().methods) {
        View view = viewOf(3840, 2160);
        view.style.method = method;
        view.quality.samples = 16;
        EXPECT_LE(priceOf(view), CostLimits().picture) << method;
    }
    View poster = viewOf(16384, 3906);
    poster.style.method = "auto";
    poster.quality.samples = 64;
    poster.quality.detail = 0.01;
    EXPECT_GT(priceOf(poster), CostLimits().picture);
}

TEST(Price, TheNearestIsDrawnAndNoNearerOneIs) {
    View poster = viewOf(8000, 4000);
    poster.quality.samples = 64;
    for (const double limit : {200'000.0, 20'000.0, 2'000.0, 200.0, 20.0, 2.0}) {
        const Admission admission(shippedRates(), {.picture = limit});
        const Problem problem = refusal(admission, poster);
        if (priceOf(poster) <= limit) {
            EXPECT_FALSE(problem.cost);
            continue;
        }
        ASSERT_TRUE(problem.cost) << limit;
        EXPECT_EQ(problem.status, 413);
        EXPECT_EQ(problem.cost->limit, limit);
        EXPECT_EQ(problem.cost->price, priceOf(poster));
        ASSERT_FALSE(problem.cost->nearest.empty());
        const View nearest = with(poster, problem.cost->nearest);
        EXPECT_LE(priceOf(nearest), limit);
        if (problem.cost->nearest.count("width") == 0) {
            View one = nearest;
            one.quality.samples = *one.quality.samples + 1;
            EXPECT_GT(priceOf(one), limit) << "one sample more";
        } else {
            EXPECT_NEAR(double(nearest.width) / nearest.height, 2, 0.05) << "of the same shape";
            EXPECT_GT(priceOf(nearest), limit / 2);
        }
        for (const auto& [word, value] : problem.cost->nearest)
            EXPECT_NE(problem.detail.find(word + "="), std::string::npos) << problem.detail;
    }
}

TEST(Price, ASessionIsToldTheSameWithoutANumber) {
    View poster = viewOf(8000, 4000);
    const Admission admission(shippedRates(), {.picture = 100});
    EXPECT_TRUE(admission.mayBeDrawn(*town(), **plan(*town(), viewOf(160, 90))));
    const auto refused = admission.mayBeDrawn(*town(), **plan(*town(), poster));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ResourceLimit);
    EXPECT_EQ(refused.error().message, refusal(admission, poster).detail);
}

TEST(Rates, OfAFileTakeThePlaceOfTheShippedOnes) {
    const auto rates = parseRates(R"({"methods": {"ewa": {"pixel": 99}}, "encoders": {"png": 3}})");
    ASSERT_TRUE(rates) << rates.error().message;
    EXPECT_EQ(rates->methods.at("ewa").pixel, 99);
    EXPECT_EQ(rates->methods.at("ewa").sample, shippedRates().methods.at("ewa").sample);
    EXPECT_EQ(rates->encoders.at("png"), 3);
    EXPECT_EQ(rates->passes, shippedRates().passes);
}

TEST(Rates, ThatAreWrongNameTheirKey) {
    for (const auto& [text, key] : std::vector<std::pair<std::string, std::string>>{
             {R"({"methods": {"ewe": {"pixel": 1}}})", "methods.ewe"},
             {R"({"methods": {"ewa": {"pixels": 1}}})", "methods.ewa.pixels"},
             {R"({"methods": {"ewa": {"pixel": -1}}})", "methods.ewa.pixel"},
             {R"({"methods": {"ewa": {"pixel": "1"}}})", "methods.ewa.pixel"},
             {R"({"methods": {"ewa": 7}})", "methods.ewa"},
             {R"({"methods": []})", "methods"},
             {R"({"passes": {"phong": 1e99}})", "passes.phong"},
             {R"({"encoders": {"gif": 1}})", "encoders.gif"},
             {R"({"prices": {}})", "prices"}}) {
        const auto rates = parseRates(text);
        ASSERT_FALSE(rates) << text;
        EXPECT_EQ(rates.error().field, key) << text;
    }
    for (const char* text : {"", "[]", "{", "null", "{\"methods\": {\"ewa\": {\"pixel\": 1}}"})
        EXPECT_FALSE(parseRates(text)) << text;
}

TEST(WorkBudget, IsForEachClientAndForAll) {
    const WorkBudget budget({.client = 100, .total = 150});
    auto first = budget.take("a", 60);
    ASSERT_TRUE(first);
    const auto tooMuch = budget.take("a", 60);
    ASSERT_FALSE(tooMuch);
    EXPECT_TRUE(tooMuch.error().ofClient);
    EXPECT_EQ(tooMuch.error().used, 60);
    const auto other = budget.take("b", 80);
    ASSERT_TRUE(other);
    const auto all = budget.take("c", 20);
    ASSERT_FALSE(all);
    EXPECT_FALSE(all.error().ofClient);
    *first = nullptr;
    EXPECT_TRUE(budget.take("c", 20)) << "and given back at once";
    EXPECT_EQ(budget.used(), 80);
}

TEST(WorkBudget, OnePieceIsAlwaysTaken) {
    const WorkBudget budget({.client = 1, .total = 1});
    const auto large = budget.take("a", 1000);
    EXPECT_TRUE(large) << "what one may cost is another limit";
    EXPECT_FALSE(budget.take("a", 1));
    EXPECT_FALSE(budget.take("b", 1));
    EXPECT_TRUE(budget.take("b", 0)) << "what costs nothing";
}

TEST(WorkBudget, IsWholeAgainWhateverThreadsDo) {
    const WorkBudget budget({.client = 10, .total = 25});
    std::vector<std::thread> crowd;
    std::atomic<int> taken{0};
    for (int t = 0; t < 4; ++t) {
        crowd.emplace_back([&, t] {
            for (int i = 0; i < 2000; ++i) {
                const auto ticket = budget.take(std::to_string(t % 3), 1 + i % 7);
                taken += ticket.has_value();
                EXPECT_LE(budget.used(), 25);
            }
        });
    }
    for (std::thread& thread : crowd) thread.join();
    EXPECT_GT(taken, 0);
    EXPECT_EQ(budget.used(), 0);
}

}  // namespace
}  // namespace scancast
