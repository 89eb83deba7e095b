// What the encoder of the tests writes, written after the same paper, comes back.
#include <gtest/gtest.h>

#include <random>

#include "importers/laz/decoder/integer_decoder.hpp"
#include "importers/laz/decoder/items/median.hpp"
#include "tests/unit/laz/arithmetic_encoder.hpp"

namespace scancast::laz {

namespace {

ArithmeticDecoder decoderOf(const std::vector<std::byte>& bytes) {
    ArithmeticDecoder decoder;
    decoder.feed.open(bytes, 0);
    decoder.start();
    return decoder;
}

template <std::uint32_t symbols>
void expectRoundTrip() {
    std::mt19937 random(symbols);
    std::geometric_distribution<std::uint32_t> often(0.1);
    std::vector<std::uint32_t> numbers(20'000);
    for (auto& number : numbers) number = random() % 16 == 0 ? random() % symbols : often(random) % symbols;
    test::ArithmeticEncoder encoder;
    auto model = std::make_unique<SymbolModel<symbols>>();
    for (const auto number : numbers) encoder.symbol(*model, number);
    const auto bytes = encoder.finish();
    auto decoder = decoderOf(bytes);
    model = std::make_unique<SymbolModel<symbols>>();
    for (const auto number : numbers) ASSERT_EQ(decoder.symbol(*model), number) << symbols;
    // Neither a byte too many nor one too few: chunks begin where the one before ends.
    EXPECT_EQ(decoder.feed.position(), bytes.size());
    EXPECT_EQ(decoder.feed.beyond(), 0U);
    EXPECT_EQ(decoder.damage(), nullptr);
}

}  // namespace

TEST(ArithmeticDecoder, GivesSymbolsBack) {
    expectRoundTrip<2>();
    expectRoundTrip<3>();
    expectRoundTrip<13>();
    expectRoundTrip<16>();
    expectRoundTrip<17>();
    expectRoundTrip<33>();
    expectRoundTrip<128>();
    expectRoundTrip<256>();
    expectRoundTrip<516>();
}

TEST(ArithmeticDecoder, GivesBitsAndIntegersBack) {
    std::mt19937 random(1);
    test::ArithmeticEncoder encoder;
    test::IntegerEncoder encoded(3);
    BitModel bitModel;
    std::vector<std::array<std::uint32_t, 4>> all(5'000);
    for (auto& [count, number, shift, seen] : all) {
        count = 1 + random() % 32;
        number = static_cast<std::uint32_t>(random()) >> (32 - count);
        shift = random() % 32;
        seen = static_cast<std::uint32_t>(random());
        encoder.bits(count, number);
        encoder.bit(bitModel, number % 8 == 0);
        encoded.encode(encoder, static_cast<std::int32_t>(seen),
                       static_cast<std::int32_t>(seen + (number >> shift)), shift % 3);
        encoded.encode(encoder, static_cast<std::int32_t>(seen),
                       static_cast<std::int32_t>(seen - (number >> shift)), shift % 3);
    }
    const auto bytes = encoder.finish();
    auto decoder = decoderOf(bytes);
    IntegerDecoder<32> integers(3);
    bitModel.reset();
    for (const auto& [count, number, shift, seen] : all) {
        ASSERT_EQ(decoder.bits(count), number);
        ASSERT_EQ(decoder.bit(bitModel), number % 8 == 0);
        ASSERT_EQ(
            static_cast<std::uint32_t>(integers.decode(decoder, static_cast<std::int32_t>(seen), shift % 3)),
            seen + (number >> shift));
        ASSERT_EQ(
            static_cast<std::uint32_t>(integers.decode(decoder, static_cast<std::int32_t>(seen), shift % 3)),
            seen - (number >> shift));
    }
    EXPECT_EQ(decoder.feed.position(), bytes.size());
    EXPECT_EQ(decoder.damage(), nullptr);
}

TEST(ArithmeticDecoder, KnowsTheEndOfItsStream) {
    const std::vector<std::byte> bytes(5, std::byte{0x55});
    auto decoder = decoderOf(bytes);
    SymbolModel<256> model;
    int symbols = 0;
    for (; !decoder.damage() && symbols < 1000; ++symbols) decoder.symbol(model);
    EXPECT_LT(symbols, 10);
    EXPECT_STREQ(decoder.damage(), "its points go on beyond its end");
    const std::vector<std::byte> nonsense(4, std::byte{0xff});
    EXPECT_STREQ(decoderOf(nonsense).damage(), "its bytes make no sense");
}

/// Of the last five that stayed, by sorting them anew each time.
TEST(Median, IsTheMiddleOfFive) {
    std::mt19937 random(2);
    Median median;
    std::vector<std::int32_t> five(5);
    bool dropsHighest = true;
    for (int i = 0; i < 2'000; ++i) {
        ASSERT_EQ(median.get(), five[2]);
        const auto number = static_cast<std::int32_t>(random() % 21) - 10;
        median.add(number);
        const bool below = dropsHighest ? number < five[2] : number <= five[2];
        five.erase(dropsHighest ? five.end() - 1 : five.begin());
        five.push_back(number);
        std::sort(five.begin(), five.end());
        dropsHighest = below;
    }
}

}  // namespace scancast::laz
