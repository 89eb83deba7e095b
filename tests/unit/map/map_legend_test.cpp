#include "renderer/map/map_legend.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "protocol/text/letter_strokes.hpp"
#include "renderer/image/colormap.hpp"
#include "renderer/image/stroke_text.hpp"
#include "renderer/together/together.hpp"

namespace scancast {
namespace {

using testing::ElementsAre;

Frame emptyFrame(int width, int height) {
    Frame frame;
    frame.width = width;
    frame.height = height;
    frame.rgba = std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 4);
    return frame;
}

/// Alpha of a pixel, 0 to 1.
double inkAt(const Frame& frame, int x, int y) {
    return frame.rgba[(std::size_t(y) * std::size_t(frame.width) + std::size_t(x)) * 4 + 3] / 255.0;
}

double allInk(const Frame& frame) {
    double ink = 0;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) ink += inkAt(frame, x, y);
    return ink;
}

TEST(StrokeText, AnUprightStrokeIsABarOfItsLengthAndWidth) {
    Frame frame = emptyFrame(40, 90);
    drawStrokeText(frame, "I", 20, 70, 60, {1, 2, 3});
    const double width = 2 * 0.42 * 60 / letterRows;
    // Its middle is x = 20, from the foot up to the height; its ends are round.
    for (const int y : {20, 40, 60}) {
        EXPECT_EQ(inkAt(frame, 19, y), 1) << y;
        EXPECT_EQ(inkAt(frame, 20, y), 1) << y;
        double across = 0;
        for (int x = 0; x < 40; ++x) across += inkAt(frame, x, y);
        EXPECT_NEAR(across, width, 0.1);
    }
    EXPECT_EQ(inkAt(frame, 20, 70 + int(width)), 0);
    EXPECT_EQ(inkAt(frame, 20, 9 - int(width)), 0);
    const double round = M_PI * width * width / 4;
    EXPECT_NEAR(allInk(frame), 60 * width + round, 6);
}

TEST(StrokeText, LinesAreAsWideAsTheyAreDrawn) {
    for (const std::string_view text :
         {"Elevation [m]", "9 water", "m\u00b2 \u2212 12.5 \u00b0", "gjpqy_{}|"}) {
        Frame frame = emptyFrame(400, 60);
        drawStrokeText(frame, text, 10, 40, 20, {0, 0, 0});
        int right = 0;
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 400; ++x)
                if (inkAt(frame, x, y) > 0.5) right = std::max(right, x);
        EXPECT_NEAR(right + 1 - 10, strokeTextWidth(text, 20) + 0.42 * 20 / letterRows, 1.1) << text;
    }
    EXPECT_EQ(strokeTextWidth("", 20), 0);
}

TEST(StrokeText, EveryCharacterOfAsciiLooksDifferent) {
    std::vector<std::vector<std::uint8_t>> seen;
    for (char letter = '!'; letter <= '~'; ++letter) {
        EXPECT_FALSE(letterStrokes(static_cast<unsigned char>(letter)).empty()) << letter;
        Frame frame = emptyFrame(24, 40);
        drawStrokeText(frame, std::string(1, letter), 3, 28, 20, {0, 0, 0});
        EXPECT_GT(allInk(frame), 0) << letter;
        // The lines of [ and |, say, differ; x and another sign may look alike.
        seen.push_back(frame.rgba.own());
    }
    std::ranges::sort(seen);
    EXPECT_EQ(std::ranges::adjacent_find(seen), seen.end());
}

TEST(StrokeText, AnyBytesAreText) {
    for (const std::string_view text :
         {"\xff", "\xc3", "\xe2\x82", "\xf0\x9f\x98\x80", "a\xc3\x28", "\x80\x01\n"}) {
        Frame frame = emptyFrame(30, 20);
        drawStrokeText(frame, text, -5, 12, 10, {0, 0, 0});
        EXPECT_GE(strokeTextWidth(text, 10), 0);
    }
}

PlannedView plannedBy(ColorSource color) {
    PlannedView planned;
    planned.view.style.color = color;
    planned.color.ramp = *colormap("viridis");
    return planned;
}

TEST(MapLegend, OfClassesListsThoseThatOccurAndAreShown) {
    Cloud cloud;
    cloud.attributes.classification = true;
    cloud.classCounts[2] = 5;
    cloud.classCounts[6] = 1;
    cloud.classCounts[70] = 3;
    PlannedView planned = plannedBy(ColorSource::Classification);
    const MapLegend all = mapLegend(cloud, planned);
    EXPECT_EQ(all.title, "Classification");
    EXPECT_THAT(all.rows, ElementsAre(MapLegend::Row{classificationColors()[2], "2 ground"},
                                      MapLegend::Row{classificationColors()[6], "6 building"},
                                      MapLegend::Row{classificationColors()[70], "70 user defined"}));
    planned.view.style.classes = std::vector<std::uint8_t>{6, 9};
    EXPECT_THAT(mapLegend(cloud, planned).rows,
                ElementsAre(MapLegend::Row{classificationColors()[6], "6 building"}));
    cloud.classCounts.fill(1);
    planned.view.style.classes.reset();
    const MapLegend many = mapLegend(cloud, planned);
    EXPECT_EQ(many.rows.size(), mostLegendRows + 1);
    EXPECT_EQ(many.rows.back(), (MapLegend::Row{std::nullopt, "and 216 more"}));
}

TEST(MapLegend, OfARampHasItsEndsAndUnit) {
    Cloud cloud;
    cloud.crsEpsg = 25833;
    PlannedView planned = plannedBy(ColorSource::Elevation);
    planned.colorRange = std::array{34.27, 101.52};
    const MapLegend legend = mapLegend(cloud, planned);
    EXPECT_EQ(legend.title, "Elevation [m]");
    EXPECT_EQ(legend.ramp.size(), 256U);
    EXPECT_THAT(legend.ends, ElementsAre("34.3", "101.5"));
    cloud.crsEpsg = 4326;
    EXPECT_EQ(mapLegend(cloud, planned).title, "Elevation") << "degrees are no unit of heights";
}

TEST(MapLegend, OfCloudsNamesThoseThatAreSeen) {
    Cloud cloud;
    cloud.title = "town";
    const PlannedView planned = plannedBy(ColorSource::Cloud);
    EXPECT_THAT(mapLegend(cloud, planned).rows, ElementsAre(MapLegend::Row{cloudColors[0], "town"}));
    const auto member = [](const std::string& title) {
        const auto of = std::make_shared<Cloud>();
        of->title = title;
        return std::shared_ptr<const Cloud>(of);
    };
    const auto together = std::make_shared<Together>();
    together->members = {
        {"a", member("2019")}, {"b", member("")}, {"c", member("2021")}, {"d", member("2022")}};
    together->members[2].hidden = true;
    together->members[3].tint = Rgb8{9, 8, 7};
    cloud.together = together;
    EXPECT_THAT(mapLegend(cloud, planned).rows,
                ElementsAre(MapLegend::Row{cloudColors[0], "2019"}, MapLegend::Row{cloudColors[1], "b"},
                            MapLegend::Row{Rgb8{9, 8, 7}, "2022"}));
}

TEST(MapLegend, EndsAreToldApart) {
    EXPECT_THAT(legendEnds({0, 255}), ElementsAre("0", "255"));
    EXPECT_THAT(legendEnds({-0.00227, 0.000561}), ElementsAre("-0.00227", "0.00056"));
    EXPECT_THAT(legendEnds({2.5, 2.5}), ElementsAre("2.5", "2.5"));
    EXPECT_THAT(legendEnds({1'210'563'478.25, 1'210'563'478.75}),
                ElementsAre("1210563478.25", "1210563478.75"));
}

TEST(MapLegend, IsDrawnAsLargeAsItSaysWithItsColoursInPlace) {
    MapLegend legend{"Elevation [m]",
                     {},
                     {"34.2", "101.5"},
                     {{Rgb8{200, 10, 20}, "2 ground"}, {std::nullopt, "and 3 more"}}};
    const Ramp ramp = *colormap("viridis");
    legend.ramp.assign(ramp.begin(), ramp.end());
    const LegendSize size = legendSize(legend);
    const Frame frame = drawLegend(legend, Rgb8{255, 255, 255});
    EXPECT_EQ(frame.width, size.width);
    EXPECT_EQ(frame.height, size.height);
    const auto colorAt = [&](int x, int y) {
        const auto at = (std::size_t(y) * std::size_t(frame.width) + std::size_t(x)) * 4;
        return Rgb8{frame.rgba[at], frame.rgba[at + 1], frame.rgba[at + 2]};
    };
    // In one row all colours of the ramp, from one end to the other.
    bool found = false;
    for (int y = 0; y < frame.height && !found; ++y) {
        std::vector<Rgb8> row;
        for (int x = 0; x < frame.width; ++x)
            if (colorAt(x, y) != Rgb8{255, 255, 255} && (row.empty() || row.back() != colorAt(x, y)))
                row.push_back(colorAt(x, y));
        found = row.size() > 100 && row.front() == ramp.front() && row.back() == ramp.back();
    }
    EXPECT_TRUE(found);
    int swatch = 0;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) swatch += colorAt(x, y) == Rgb8{200, 10, 20} ? 1 : 0;
    EXPECT_EQ(swatch, 18 * 11);
    const Frame clear = drawLegend(legend, std::nullopt);
    EXPECT_EQ(clear.rgba[3], 0);
    legend.title.assign(5000, 'W');
    EXPECT_LE(legendSize(legend).width, 640);
    EXPECT_EQ(drawLegend(legend, std::nullopt).width, legendSize(legend).width);
}

}  // namespace
}  // namespace scancast
