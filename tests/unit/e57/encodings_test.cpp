// Every encoding of a number, in packets of any cut: what the writer put in is what the stream brings, to the last bit. The
// writer packs bit by bit and shares nothing with the reader.
#include <gmock/gmock.h>

#include <limits>

#include "importers/e57/crc32c.hpp"
#include "tests/unit/e57/imported.hpp"

namespace scancast::test {

namespace {

/// A number for each record and field that depends on both alone.
std::uint64_t scramble(std::uint64_t record, std::size_t field) {
    std::uint64_t x = (record + 1) * 0x9e3779b97f4a7c15ULL + field * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    return x ^ (x >> 31);
}

std::int64_t within(const E57Field& field, std::uint64_t random) {
    const auto range = static_cast<std::uint64_t>(field.maximum) - static_cast<std::uint64_t>(field.minimum);
    const auto offset = range == std::numeric_limits<std::uint64_t>::max() ? random : random % (range + 1);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(field.minimum) + offset);
}

/// Some of the least and the greatest, too.
E57Scan randomScan(std::vector<E57Field> fields, std::uint64_t records, bool odd) {
    E57Scan scan;
    scan.fields = fields;
    scan.records = records;
    scan.oddPackets = odd;
    scan.raw = [fields](std::uint64_t record, std::size_t field) {
        if (record % 17 == 3) return fields[field].minimum;
        if (record % 17 == 5) return fields[field].maximum;
        return within(fields[field], scramble(record, field));
    };
    scan.real = [](std::uint64_t record, std::size_t field) {
        return static_cast<double>(scramble(record, field) % 2'000'003) / 97.0 - 1e4;
    };
    return scan;
}

double expected(const E57Scan& scan, std::uint64_t record, std::size_t field) {
    const auto& f = scan.fields[field];
    if (f.kind == E57Field::Kind::Double) return scan.real(record, field);
    if (f.kind == E57Field::Kind::Single)
        return static_cast<double>(static_cast<float>(scan.real(record, field)));
    return static_cast<double>(scan.raw(record, field)) * f.scale + f.offset;
}

void expectPositions(const E57Scan& scan, const Expected<Imported>& result) {
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_EQ(result->points.size(), scan.records);
    for (std::uint64_t i = 0; i < scan.records; ++i)
        for (int axis = 0; axis < 3; ++axis)
            ASSERT_EQ(result->points.position[i][axis], expected(scan, i, static_cast<std::size_t>(axis)))
                << "record " << i << ", axis " << axis;
}

/// `bits` wide, around a minimum that is not zero.
E57Field ofBits(const std::string& name, unsigned bits, bool scaled) {
    const auto range = bits == 0 ? 0 : ~std::uint64_t(0) >> (64 - bits);
    const auto minimum =
        bits == 64 ? std::numeric_limits<std::int64_t>::min() : -static_cast<std::int64_t>(range / 3);
    const auto maximum = static_cast<std::int64_t>(static_cast<std::uint64_t>(minimum) + range);
    return scaled ? E57Field::scaled(name, minimum, maximum, 0.0009765625, 12.5)
                  : E57Field::integer(name, minimum, maximum);
}

}  // namespace

TEST(Encodings, IntegersOfAnyWidth) {
    for (unsigned bits = 0; bits <= 64; ++bits)
        for (const bool odd : {false, true}) {
            SCOPED_TRACE(bits);
            const auto scan = randomScan({ofBits("cartesianX", bits, true), ofBits("cartesianY", bits, false),
                                          ofBits("cartesianZ", (bits + 7) % 65, true)},
                                         301, odd);
            EXPECT_EQ(scan.fields[0].bits(), bits);
            expectPositions(scan, imported(e57File({scan})));
        }
}

TEST(Encodings, FloatsBesideIntegers) {
    for (const bool odd : {false, true}) {
        const auto scan = randomScan({E57Field::single("cartesianX"), E57Field::real("cartesianY"),
                                      ofBits("cartesianZ", 19, true), ofBits("ext:strange", 13, false)},
                                     5000, odd);
        expectPositions(scan, imported(e57File({scan})));
    }
}

// More than a block of the reader, more than a chunk of the stream, and more in each packet than in the one before.
TEST(Encodings, ManyRecords) {
    for (const bool odd : {false, true}) {
        const auto scan = randomScan(
            {E57Field::single("cartesianX"), ofBits("cartesianY", 33, true), ofBits("cartesianZ", 0, true)},
            odd ? 20'001 : 150'003, odd);
        expectPositions(scan, imported(e57File({scan})));
    }
}

TEST(Encodings, RecordsWithoutBits) {
    const auto scan = randomScan(
        {ofBits("cartesianX", 0, true), ofBits("cartesianY", 0, true), ofBits("cartesianZ", 0, true)}, 9000,
        false);
    expectPositions(scan, imported(e57File({scan})));
}

// A value beyond a range that is no power of two is what its bits say: nobody else refuses it either.
TEST(Encodings, RangesThatAreNoPowersOfTwo) {
    auto scan = randomScan({E57Field::integer("cartesianX", 10, 14), E57Field::integer("cartesianY", -5, 5),
                            E57Field::integer("cartesianZ", 0, 9)},
                           100, true);
    EXPECT_EQ(scan.fields[0].bits(), 3U);
    EXPECT_EQ(scan.fields[2].bits(), 4U);
    expectPositions(scan, imported(e57File({scan})));
}

TEST(Crc32c, IsCastagnolis) {
    // The check value that catalogues of CRCs print for it.
    const std::string digits = "123456789";
    const auto bytes = std::as_bytes(std::span<const char>(digits));
    EXPECT_EQ(import_e57::crc32cByTable(bytes), 0xe3069283U);
    for (std::size_t n = 0; n <= digits.size(); ++n)
        EXPECT_EQ(import_e57::crc32c(bytes.first(n)), import_e57::crc32cByTable(bytes.first(n)));
}

}  // namespace scancast::test
