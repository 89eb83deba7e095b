// What is damaged, cut off, or made to harm: a clear sentence each, and no crash, no endless work, no memory that a few bytes
// ask for.
#include <gmock/gmock.h>

#include <cstring>

#include "importers/e57/file_description.hpp"
#include "importers/e57/record_reader.hpp"
#include "importers/e57/xml_records.hpp"
#include "tests/support/sized.hpp"
#include "tests/unit/e57/imported.hpp"

namespace scancast::test {

using ::testing::HasSubstr;

namespace {

E57Scan soundScan(std::uint64_t records = 500) {
    E57Scan scan;
    scan.fields = {E57Field::single("cartesianX"), E57Field::scaled("cartesianY", -100, 100, 0.01),
                   E57Field::real("cartesianZ")};
    scan.records = records;
    scan.real = [](std::uint64_t record, std::size_t) { return static_cast<double>(record); };
    scan.raw = [](std::uint64_t record, std::size_t) { return static_cast<std::int64_t>(record % 100); };
    return scan;
}

/// A sound file with these bytes at a physical offset, and checksums that are right.
template <class T>
std::string changed(std::size_t at, T value, std::string file = e57File({soundScan()})) {
    std::memcpy(file.data() + at, &value, sizeof value);
    sealPages(file);
    return file;
}

std::string replaced(std::string file, std::string_view from, std::string_view to) {
    const auto at = file.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    EXPECT_EQ(from.size(), to.size());
    file.replace(at, from.size(), to);
    sealPages(file);
    return file;
}

std::string fileWithXml(const std::string& xml) {
    std::stringstream out(std::ios::in | std::ios::out | std::ios::binary);
    E57Writer(out).finishWith(xml);
    return out.str();
}

std::string pointsXml(const std::string& points) {
    return "<e57Root><data3D><vectorChild>" + points + "</vectorChild></data3D></e57Root>";
}

}  // namespace

TEST(E57Damage, OfAPageIsFoundWhereverItIs) {
    const auto sound = e57File({soundScan()});
    ASSERT_TRUE(imported(sound));
    ASSERT_GT(sound.size(), 6 * 1024U);
    for (std::size_t page = 0; page * 1024 < sound.size(); ++page) {
        auto file = sound;
        file[page * 1024 + 700 + page % 6 * 50] ^= 0x10;
        expectRefused(file, ErrorCode::Malformed, "is damaged: its checksum is another");
    }
    auto file = sound;
    file[2 * 1024 + 1022] ^= 1;  // the checksum itself
    expectRefused(file, ErrorCode::Malformed, "the page at byte 2,048 is damaged");
}

TEST(E57Damage, TruncatedFilesSayWhatIsMissing) {
    const auto sound = e57File({soundScan()});
    for (std::size_t bytes = 0; bytes < sound.size(); bytes += bytes < 60 ? 1 : 509) {
        const auto result = imported(sound.substr(0, bytes));
        ASSERT_FALSE(result) << bytes;
        EXPECT_EQ(name(result.error().code), name(ErrorCode::Truncated)) << bytes << result.error().message;
    }
    expectRefused(sound.substr(0, 4096), ErrorCode::Truncated, "it ends at byte 4,096: its header gives it");
    EXPECT_THAT(imported(sound + "xy")->notes, ::testing::ElementsAre(HasSubstr("2 bytes follow its end")));
}

TEST(E57Damage, HeadersThatLieAreRefused) {
    expectRefused("ASTM-E56", ErrorCode::Malformed, "byte 0: it does not start as an E57 file does");
    expectRefused(changed(8, std::uint32_t(2)), ErrorCode::Unsupported,
                  "it is E57 version 2.0; 1.0 can be read");
    expectRefused(changed(16, std::uint64_t(1000)), ErrorCode::Malformed, "no whole pages");
    expectRefused(changed(16, ~std::uint64_t(0) - 1023), ErrorCode::Truncated, "its header gives it");
    expectRefused(changed(24, std::uint64_t(1021)), ErrorCode::Malformed,
                  "begin at byte 1,021, where nothing can");
    expectRefused(changed(24, ~std::uint64_t(0)), ErrorCode::Malformed, "where nothing can");
    expectRefused(changed(32, ~std::uint64_t(0)), ErrorCode::Malformed,
                  "its description (XML) is said to have");
    expectRefused(changed(32, std::uint64_t(100)), ErrorCode::Malformed,
                  "its description (XML) is wrong in line");
    expectRefused(changed(40, std::uint64_t(4096)), ErrorCode::Unsupported, "its pages have 4,096 bytes");
}

TEST(E57Damage, SectionsThatLieAreRefused) {
    expectRefused(changed(48, std::uint8_t(9)), ErrorCode::Malformed,
                  "byte 48: its scan: its points should begin here");
    expectRefused(changed(56, ~std::uint64_t(0)), ErrorCode::Malformed, "its points are said to take");
    expectRefused(changed(56, std::uint64_t(31)), ErrorCode::Malformed,
                  "its points are said to take 31 bytes");
    expectRefused(changed(56, std::uint64_t(1000)), ErrorCode::Malformed,
                  "500 points of 104 bits are promised");
    expectRefused(changed(64, std::uint64_t(1023)), ErrorCode::Malformed,
                  "its first packet is said to begin at");
    expectRefused(changed(64, std::uint64_t(48)), ErrorCode::Malformed, "its first packet lies outside");
}

TEST(E57Damage, PacketsThatLieAreRefused) {
    constexpr std::size_t packet = 80;
    expectRefused(changed(packet, std::uint8_t(3)), ErrorCode::Malformed, "a packet of type 3");
    expectRefused(changed(packet + 2, std::uint16_t(0xffff)), ErrorCode::Malformed,
                  "a packet of 65536 bytes");
    expectRefused(changed(packet + 2, std::uint16_t(2)), ErrorCode::Malformed, "a packet of 3 bytes");
    expectRefused(changed(packet + 4, std::uint16_t(2)), ErrorCode::Malformed,
                  "2 bytestreams, and points with 3 fields");
    expectRefused(changed(packet + 6, std::uint16_t(0xffff)), ErrorCode::Malformed,
                  "bytestreams are longer than it");
    // Less than was promised.
    expectRefused(changed(packet + 6, std::uint16_t(40)), ErrorCode::Truncated,
                  "500 are promised, there are 10");
}

TEST(E57Damage, NumbersOfPointsThatNoFileHoldsAreRefused) {
    const auto sound = e57File({soundScan()});
    expectRefused(replaced(sound, "recordCount=\"500\"", "recordCount=\"900\""), ErrorCode::Malformed,
                  "900 points of 104 bits are promised");
    expectRefused(replaced(sound, "recordCount=\"500\"", "recordCount=\"-12\""), ErrorCode::Malformed,
                  "scan 1: its number of points is \"-12\"");
    E57Scan constant;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
        constant.fields.push_back(E57Field::integer(name, 7, 7));
    constant.records = 1'000;
    constant.raw = [](auto, auto) { return 7; };
    EXPECT_EQ(imported(e57File({constant}))->points.size(), 1'000U);
    constant.records = 99'999;
    expectRefused(e57File({constant}), ErrorCode::Malformed, "99,999 points of 0 bits are promised");
    expectRefused(
        fileWithXml(pointsXml("<points fileOffset=\"48\" recordCount=\"18446744073709551615\"><prototype/>"
                              "</points>")),
        ErrorCode::Malformed, "more points than any file can hold");
}

TEST(E57Damage, FieldsThatCannotBeAreRefused) {
    const auto field = [](const std::string& attributes) {
        return fileWithXml(pointsXml("<points fileOffset=\"48\" recordCount=\"1\"><prototype><cartesianX " +
                                     attributes + "/></prototype></points>"));
    };
    expectRefused(field(R"(type="Integer" minimum="5" maximum="4")"), ErrorCode::Malformed,
                  "the maximum of its field");
    expectRefused(field(R"(type="Integer" minimum="99999999999999999999")"), ErrorCode::Malformed, "minimum");
    expectRefused(field(R"(type="ScaledInteger" scale="0")"), ErrorCode::Malformed, "the scale of its field");
    expectRefused(field(R"(type="ScaledInteger" scale="inf")"), ErrorCode::Malformed, "scale");
    expectRefused(field(R"(type="ScaledInteger" offset="x")"), ErrorCode::Malformed, "offset");
    expectRefused(field(R"(type="Integer")"), ErrorCode::Unsupported, "have no coordinates");
    expectRefused(
        fileWithXml(pointsXml("<points recordCount=\"1\"><prototype><cartesianX type=\"Float\"/><cartesianX "
                              "type=\"Float\"/></prototype></points>")),
        ErrorCode::Malformed, "two of its fields");
    expectRefused(fileWithXml(pointsXml("<points recordCount=\"1\"/>")), ErrorCode::Malformed, "prototype");
    std::string many = "<points recordCount=\"1\"><prototype>";
    for (int i = 0; i < 513; ++i) many += "<f" + std::to_string(i) + " type=\"Float\"/>";
    expectRefused(fileWithXml(pointsXml(many + "</prototype></points>")), ErrorCode::Malformed,
                  "more than 512 fields");
}

TEST(E57Xml, WithEntitiesOfItsOwnIsRefused) {
    std::string laughs = "<!DOCTYPE lolz [<!ENTITY a \"ha\">";
    for (char c = 'b'; c < 'm'; ++c) {
        const std::string before(1, static_cast<char>(c - 1));
        laughs += std::string("<!ENTITY ") + c + " \"";
        for (int i = 0; i < 10; ++i) laughs += "&" + before + ";";
        laughs += "\">";
    }
    expectRefused(fileWithXml(laughs + "]><e57Root><coordinateMetadata>&l;</coordinateMetadata></e57Root>"),
                  ErrorCode::Malformed, "it has a document type");
    expectRefused(fileWithXml("<!DOCTYPE e57Root SYSTEM \"file:///etc/passwd\"><e57Root/>"),
                  ErrorCode::Malformed, "it has a document type");
    expectRefused(fileWithXml("<e57Root>&unknown;</e57Root>"), ErrorCode::Malformed, "undefined entity");
}

TEST(E57Xml, ThatIsTooDeepOrTooLongIsRefused) {
    std::string deep;
    for (int i = 0; i < 100; ++i) deep += "<a>";
    expectRefused(fileWithXml("<e57Root>" + deep), ErrorCode::Malformed, "elements lie too deep");
    std::string wide;
    for (std::size_t i = 0; i <= import_e57::mostRecordElements; ++i) wide += "<a/>";
    expectRefused(fileWithXml(pointsXml(wide)), ErrorCode::ResourceLimit,
                  "longer description than any needs");
    expectRefused(
        fileWithXml("<e57Root><coordinateMetadata>" + std::string(import_e57::mostRecordBytes, 'x')),
        ErrorCode::ResourceLimit, "longer description than any needs");
    std::string scans;
    for (int i = 0; i < 65'600; ++i) scans += "<vectorChild/>";
    expectRefused(fileWithXml("<e57Root><data3D>" + scans + "</data3D></e57Root>"), ErrorCode::ResourceLimit,
                  "more than 65,535 scans");
}

TEST(E57Xml, ThatIsNotE57OrBrokenIsRefused) {
    expectRefused(fileWithXml("<html/>"), ErrorCode::Malformed, "the first element is \"html\"");
    expectRefused(fileWithXml("<e57Root><data3D></e57Root>"), ErrorCode::Malformed, "mismatched tag");
    expectRefused(fileWithXml("<e57Root>"), ErrorCode::Malformed, "its description (XML) is wrong in line 1");
    expectRefused(fileWithXml(std::string("<e57Root>\n\n\x01", 12)), ErrorCode::Malformed, "line 3");
    expectRefused(fileWithXml("<e57Root/>"), ErrorCode::Empty, "an E57 file without scans");
    expectRefused(fileWithXml(pointsXml("")), ErrorCode::Unsupported, "no coordinates");
}

// Prefixes that nobody declared, extensions with anything in them, blanks behind the end.
TEST(E57Xml, OfExtensionsIsLeftOut) {
    auto scan = soundScan(3);
    scan.xml =
        "<las:vlrs><vectorChild><points recordCount=\"77\"/></vectorChild></las:vlrs><unknown><a/></unknown>";
    scan.fields.push_back(E57Field::integer("undeclared:thing", 0, 77));
    const auto result = imported(e57File({scan}, "<ext:other>text</ext:other><ext:more/>"));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->points.size(), 3U);
}

// All of one field before all of the next is allowed; what waits for it in memory has a bound.
TEST(E57Damage, FieldsFarAheadOfOthersAreRefused) {
    auto scan = soundScan(200'000);
    scan.streamByStream = true;
    const auto file = e57File({scan});
    const auto result = imported(file);
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_EQ(result->points.size(), 200'000U);
    EXPECT_EQ(result->points.position[199'999], glm::dvec3(199'999, 0.99, 199'999));
    auto pages = import_e57::PagedFile::open(std::make_unique<MemoryByteSource>(std::as_bytes(
                                                 std::span<const char>(file.data(), file.size()))))
                     .value();
    const auto description = import_e57::describeFile(pages).value();
    const std::array wanted{0, 1, 2};
    auto reader =
        import_e57::RecordReader::open(pages, description.scans[0], wanted, "its scan", std::size_t(1) << 20)
            .value();
    const auto block = reader.next();
    ASSERT_FALSE(block);
    EXPECT_EQ(block.error().code, ErrorCode::ResourceLimit);
    EXPECT_THAT(block.error().message,
                HasSubstr("its scan: some of its fields are more than 1 MB ahead of others"));
}

// Any byte that is another, with right checksums: an answer.
TEST(E57Damage, OfAnyByteIsSurvived) {
    auto scan = soundScan(40);
    scan.xml = e57Pose(1, 0, 0, 0, 1, 2, 3);
    scan.oddPackets = true;
    const auto sound = e57File({scan, soundScan(20)});
    for (std::size_t at = 0; at < sound.size(); at += sized<std::size_t>(1, 5)) {
        auto file = sound;
        file[at] = static_cast<char>(file[at] + 1 + static_cast<char>(at % 7));
        sealPages(file);
        const auto result = imported(file);
        if (!result) {
            EXPECT_FALSE(result.error().message.empty());
        }
    }
}

}  // namespace scancast::test
