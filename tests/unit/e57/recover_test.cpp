// Damaged pages and files that were cut, with --recover: exactly the points that lie in whole pages, and how many are lost.
// Oracle: the bytes of every point, found by walking the sound file's packets one after the other here.
#include <gmock/gmock.h>

#include <cstring>
#include <set>

#include "importers/e57/file_description.hpp"
#include "renderer/cloud/import/lost_points.hpp"
#include "tests/support/sized.hpp"
#include "tests/unit/e57/imported.hpp"

namespace scancast::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

constexpr import_e57::Choices recover{.recover = true};
constexpr std::size_t inPage = 1020;

E57Scan scanFrom(double first, std::uint64_t records) {
    E57Scan scan;
    scan.fields = {E57Field::single("cartesianX"), E57Field::scaled("cartesianY", -1000, 1000, 0.01),
                   E57Field::real("cartesianZ"), E57Field::integer("rowIndex", 0, 0x7fffffff)};
    scan.records = records;
    scan.real = [=](std::uint64_t record, std::size_t) { return first + static_cast<double>(record); };
    scan.raw = [](std::uint64_t record, std::size_t) { return static_cast<std::int64_t>(record % 1000); };
    return scan;
}

std::string withoutChecksums(const std::string& file) {
    std::string content;
    for (std::size_t at = 0; at < file.size(); at += 1024) content += file.substr(at, inPage);
    return content;
}

std::string withChecksums(const std::string& content) {
    std::string file;
    for (std::size_t at = 0; at < content.size(); at += inPage) {
        file += content.substr(at, inPage);
        file.resize((file.size() + 1023) / 1024 * 1024);
    }
    sealPages(file);
    return file;
}

template <class T>
T numberAt(const std::string& content, std::size_t at) {
    T value{};
    std::memcpy(&value, content.data() + at, sizeof value);
    return value;
}

std::size_t logical(std::uint64_t physical) {
    return physical / 1024 * inPage + physical % 1024;
}

/// Where each byte of a scan's streams lies, and which heads have to be read on the way to it.
class ScanBytes {
  public:
    ScanBytes(const std::string& content, std::size_t section, const E57Scan& scan)
        : scan_(scan), section_(section), streams_(scan.fields.size()) {
        auto at = logical(numberAt<std::uint64_t>(content, section + 16));
        const auto end = section + numberAt<std::uint64_t>(content, section + 8);
        while (at < end) {
            const std::size_t length = numberAt<std::uint16_t>(content, at + 2) + std::size_t(1);
            const bool data = content[at] == 1;
            heads_.push_back({at, at + 6 + (data ? 2 * streams_.size() : 0)});
            auto from = heads_.back().second;
            for (std::size_t field = 0; data && field < streams_.size(); ++field)
                for (auto n = numberAt<std::uint16_t>(content, at + 6 + 2 * field); n > 0; --n)
                    streams_[field].push_back({from++, heads_.size()});
            at += length;
        }
    }

    /// By its number, whether each record of the first `fields` fields is whole.
    std::vector<bool> whole(const std::vector<bool>& soundPages, std::size_t fields) const {
        const auto sound = [&](std::size_t begin, std::size_t end) {
            for (auto page = begin / inPage; page <= (end - 1) / inPage; ++page)
                if (!soundPages[page]) return false;
            return true;
        };
        std::size_t heads = 0;
        if (sound(section_, section_ + 32))
            while (heads < heads_.size() && sound(heads_[heads].first, heads_[heads].second)) ++heads;
        std::vector<bool> result(scan_.records, true);
        for (std::size_t field = 0; field < fields; ++field)
            for (std::size_t record = 0; record < scan_.records; ++record) {
                const std::size_t bits = scan_.fields[field].bits();
                for (auto byte = record * bits / 8; byte <= (record * bits + bits - 1) / 8; ++byte) {
                    const auto [at, behindHeads] = streams_[field][byte];
                    if (behindHeads > heads || !soundPages[at / inPage]) result[record] = false;
                }
            }
        return result;
    }

  private:
    const E57Scan& scan_;
    std::size_t section_;
    std::vector<std::pair<std::size_t, std::size_t>> heads_;
    std::vector<std::vector<std::pair<std::size_t, std::size_t>>> streams_;  ///< place, heads before it
};

/// A file whose pages can be damaged, and what is whole of it then.
class Damageable {
  public:
    Damageable(std::vector<E57Scan> scans, std::string file)
        : file(std::move(file)), scans_(std::move(scans)) {
        const auto content = withoutChecksums(this->file);
        auto pages = import_e57::PagedFile::open(
                         std::make_unique<MemoryByteSource>(std::as_bytes(std::span<const char>(this->file))))
                         .value();
        const auto described = import_e57::describeFile(pages).value();
        for (std::size_t i = 0; i < scans_.size(); ++i)
            bytes_.emplace_back(content, logical(described.scans[i].section), scans_[i]);
        firstPageOfXml = pages.header().xmlOffset / 1024;
        sound_ = imported(this->file).value().points;
    }
    explicit Damageable(const std::vector<E57Scan>& scans) : Damageable(scans, e57File(scans)) {}

    std::size_t pages() const { return file.size() / 1024; }

    /// `given`: the file with damage there.
    void expectWhole(const std::string& given, const std::vector<bool>& soundPages,
                     bool keepAttributes = false) {
        const std::size_t fields = keepAttributes ? 4 : 3;
        std::vector<glm::dvec3> expected;
        std::vector<std::size_t> wholes;
        std::size_t before = 0;
        for (std::size_t i = 0; i < scans_.size(); ++i) {
            const auto whole = bytes_[i].whole(soundPages, fields);
            const auto had = expected.size();
            for (std::size_t record = 0; record < whole.size(); ++record)
                if (whole[record]) expected.push_back(sound_.position[before + record]);
            wholes.push_back(expected.size() - had);
            before += whole.size();
        }
        const auto got = imported(given, {.keepAttributes = keepAttributes, .recover = true});
        if (expected.empty()) {
            ASSERT_FALSE(got);
            EXPECT_THAT(got.error().message, HasSubstr("not one is whole"));
            return;
        }
        ASSERT_TRUE(got) << got.error().message;
        EXPECT_EQ(got->header.points, expected.size());
        ASSERT_EQ(got->points.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i)
            ASSERT_EQ(got->points.position[i], expected[i]) << i;
        std::size_t told = 0;
        for (std::size_t i = 0; i < scans_.size(); ++i) {
            if (wholes[i] == scans_[i].records) continue;
            ASSERT_LT(told, got->notes.size());
            EXPECT_THAT(got->notes[told],
                        ::testing::EndsWith(": " + lostShare(scans_[i].records, wholes[i])));
            ++told;
        }
        lost += told;
    }

    void expectWithout(const std::set<std::size_t>& damaged, bool keepAttributes = false) {
        auto given = file;
        std::vector<bool> sound(pages(), true);
        for (const auto page : damaged) {
            given[page * 1024 + 100 + page * 7 % 900] ^= 4;
            sound[page] = false;
        }
        expectWhole(given, sound, keepAttributes);
    }

    const std::string file;
    std::size_t firstPageOfXml = 0;
    std::size_t lost = 0;  ///< scans of which something was, so far

  private:
    std::vector<E57Scan> scans_;
    std::vector<ScanBytes> bytes_;
    PointBatch sound_;
};

}  // namespace

// One packet: what is behind the damage is there, too.
TEST(E57Recover, ThePagesOfAPacketInEveryCombination) {
    Damageable made({scanFrom(0, 300)});
    ASSERT_EQ(made.firstPageOfXml, 5U);
    for (unsigned mask = 0; mask < 32; ++mask) {
        std::set<std::size_t> damaged;
        for (std::size_t page = 0; page < 5; ++page)
            if ((mask >> page & 1U) != 0) damaged.insert(page);
        SCOPED_TRACE(mask);
        made.expectWithout(damaged);
        made.expectWithout(damaged, true);
    }
    // Something is left where neither the scan's head nor all of y is damaged (pages 0, 1), and with row numbers not page 3 beside page 4.
    EXPECT_EQ(made.lost, 7U + 5U);
    auto file = made.file;
    file[2 * 1024 + 5] ^= 1;
    const auto got = imported(file, recover);
    ASSERT_TRUE(got) << got.error().message;
    EXPECT_THAT(got->notes[0],
                HasSubstr("its scan is damaged at byte 2,048: of the 300 points that it promises, "));
    expectRefused(
        file, ErrorCode::Malformed,
        "the page at byte 2,048 is damaged: its checksum is another; ingest --recover reads what is whole");
}

// Index packets and ignored ones between, streams that are ahead of others, blocks of records that end within packets.
TEST(E57Recover, AnyPageOfManyPackets) {
    auto odd = scanFrom(0, 1500);
    odd.oddPackets = true;
    auto ahead = scanFrom(50'000, 9000);
    ahead.streamByStream = true;
    Damageable made({odd, scanFrom(10'000, 9000), ahead});
    for (std::size_t page = 0; page < made.firstPageOfXml; page += sized<std::size_t>(1, 9)) {
        SCOPED_TRACE(page);
        made.expectWithout({page});
        made.expectWithout({page, (page * 7 + 3) % made.firstPageOfXml, made.firstPageOfXml - 1});
    }
    EXPECT_GT(made.lost, made.firstPageOfXml / sized<std::size_t>(1, 9));
}

TEST(E57Recover, OfASoundFileChangesNothing) {
    const auto file = e57File({scanFrom(0, 300), scanFrom(1000, 20)});
    const auto without = imported(file).value(), with = imported(file, recover).value();
    EXPECT_EQ(with.header.points, 320U);
    EXPECT_EQ(with.points.position, without.points.position);
    EXPECT_EQ(with.notes, without.notes);
}

TEST(E57Recover, ScansThatHaveLessThanTheyPromise) {
    auto file = e57File({scanFrom(0, 300)});
    const std::uint16_t bytes = 40;  // of the first stream, ten numbers
    std::memcpy(file.data() + 80 + 6, &bytes, sizeof bytes);
    sealPages(file);
    EXPECT_FALSE(imported(file));
    const auto got = imported(file, recover);
    ASSERT_TRUE(got) << got.error().message;
    EXPECT_EQ(got->points.size(), 10U);
    EXPECT_THAT(got->notes[0], lostPoints("its scan", 300, 10));
}

TEST(E57Recover, ADamagedDescriptionIsTheEnd) {
    const auto sound = e57File({scanFrom(0, 300)});
    for (const auto& choices : {import_e57::Choices(), recover}) {
        auto file = sound;
        file[file.size() - 1024] ^= 1;
        auto got = imported(file, choices);
        ASSERT_FALSE(got);
        EXPECT_THAT(
            got.error().message,
            HasSubstr("is damaged: its checksum is another. It has what describes its scans (XML), without "
                      "which no point can be read"));
        got = imported(sound.substr(0, sound.size() - 1024), choices);
        ASSERT_FALSE(got);
        EXPECT_EQ(got.error().code, ErrorCode::Truncated);
        EXPECT_THAT(got.error().message, HasSubstr("What describes its scans (XML) began at byte"));
        EXPECT_THAT(got.error().message, HasSubstr("not by --recover either"));
    }
}

// With the description before the points a file that was cut has it still.
TEST(E57Recover, FilesCutBehindTheirDescription) {
    const auto scan = scanFrom(0, 3000);
    const auto content = withoutChecksums(e57File({scan}));
    const auto xmlBegin = logical(numberAt<std::uint64_t>(content, 24));
    auto xml = content.substr(xmlBegin, numberAt<std::uint64_t>(content, 32));
    auto section = content.substr(48, xmlBegin - 48);
    const std::string old = "fileOffset=\"48\"";
    const auto named = xml.find(old);
    ASSERT_NE(named, xml.npos);
    const std::size_t begin = (48 + xml.size() + 100) / 4 * 4;
    const auto physical = [](std::size_t at) { return std::uint64_t(at / inPage * 1024 + at % inPage); };
    xml.replace(named, old.size(), "fileOffset=\"" + std::to_string(physical(begin)) + "\"");
    const auto put = [](std::string& bytes, std::size_t at, std::uint64_t value) {
        std::memcpy(bytes.data() + at, &value, sizeof value);
    };
    put(section, 16, physical(begin + 32));
    auto moved = content.substr(0, 48) + xml;
    moved.resize(begin, ' ');
    moved += section;
    put(moved, 16, (moved.size() + inPage - 1) / inPage * 1024);
    put(moved, 24, 48);
    put(moved, 32, xml.size());
    Damageable made({scan}, withChecksums(moved));
    const auto behindXml = physical(begin) / 1024 * 1024;
    for (std::size_t bytes = behindXml + 1024; bytes < made.file.size();
         bytes += sized<std::size_t>(311, 2111)) {
        SCOPED_TRACE(bytes);
        std::vector<bool> sound(made.pages(), false);
        std::fill_n(sound.begin(), bytes / 1024, true);
        made.expectWhole(made.file.substr(0, bytes), sound);
    }
    EXPECT_GT(made.lost, 0U);
    const auto cut = made.file.substr(0, made.file.size() / 2);
    EXPECT_THAT(imported(cut, recover).value().notes,
                ElementsAre(HasSubstr("its scan ends too early: of the 3,000 points that it promises, ")));
    expectRefused(cut, ErrorCode::Truncated, "its header gives it");
}

// Where nearly all is constant, few bytes have many points: not more than what is there of the file may have.
TEST(E57Recover, ConstantsOfACutFileHaveABound) {
    std::string xml =
        "<e57Root><data3D><vectorChild><points fileOffset=\"2048\" "
        "recordCount=\"4000000000000000000\"><prototype>";
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
        xml += std::string("<") + name + " type=\"Integer\" minimum=\"7\" maximum=\"7\"/>";
    xml += "</prototype></points></vectorChild></data3D></e57Root>";
    std::string content(3 * inPage, '\0');
    const auto put = [&](std::size_t at, std::uint64_t value) {
        std::memcpy(content.data() + at, &value, sizeof value);
    };
    content.replace(0, 8, "ASTM-E57");
    put(8, 1);
    put(16, std::uint64_t(1) << 62);
    put(24, 48);
    put(32, xml.size());
    put(40, 1024);
    content.replace(48, xml.size(), xml);
    content[2 * inPage] = 1;
    put(2 * inPage + 8, std::uint64_t(1) << 61);
    put(2 * inPage + 16, 2048 + 32);
    const auto got = imported(withChecksums(content), recover);
    ASSERT_TRUE(got) << got.error().message;
    EXPECT_EQ(got->points.size(), (inPage - 32) * 1000);
}

TEST(E57Recover, ManyDamagedScansAreToldInASum) {
    std::vector<E57Scan> scans;
    for (int i = 0; i < 23; ++i) scans.push_back(scanFrom(i * 1000, 300));
    auto file = e57File(scans);
    const auto xml = numberAt<std::uint64_t>(file, 24) / 1024;
    for (std::size_t page = 1; page < xml; page += 2) file[page * 1024] ^= 1;
    const auto got = imported(file, recover);
    ASSERT_TRUE(got) << got.error().message;
    ASSERT_GT(got->notes.size(), 3U);
    EXPECT_THAT(got->notes[2], HasSubstr(" is damaged at byte "));
    EXPECT_THAT(got->notes[3], HasSubstr("20 scans more are damaged or end too early: of the 6,000 points"));
    EXPECT_LT(got->points.size(), 23 * 300U);
}

}  // namespace scancast::test
