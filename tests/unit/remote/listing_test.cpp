// Which clouds there are behind a URL: what S3 answers and what lists at web servers hold, read by what their descriptions say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "remote/access.hpp"
#include "remote/cloud_list.hpp"
#include "remote/object_list.hpp"
#include "remote/remote_listing.hpp"
#include "tests/unit/remote/range_server.hpp"

namespace scancast::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// After "ListObjectsV2" in Amazon's reference, with what stands around it in practice.
const std::string onePage = R"(<?xml version="1.0" encoding="UTF-8"?>
<ListBucketResult xmlns="http://s3.amazonaws.com/doc/2006-03-01/">
  <Name>scans</Name><Prefix>area/</Prefix><KeyCount>2</KeyCount><MaxKeys>1000</MaxKeys>
  <Delimiter>/</Delimiter><IsTruncated>false</IsTruncated>
  <Contents><Key>area/town.scan</Key><LastModified>2026-11-26T03:00:00.000Z</LastModified>
    <ETag>&quot;70ee1738&quot;</ETag><Size>10</Size><Owner><ID>x</ID></Owner><StorageClass/></Contents>
  <Contents><Key>area/a &amp; b &#x3c;&#228;&gt;.scan</Key><Size>3</Size></Contents>
  <CommonPrefixes><Prefix>area/old/</Prefix></CommonPrefixes>
</ListBucketResult>
)";

std::string changed(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(ObjectListTest, readsKeysAndWhetherThereIsMore) {
    const auto page = parseObjectPage(onePage);
    ASSERT_TRUE(page) << page.error().message;
    ASSERT_EQ(page->objects.size(), 2u);
    EXPECT_EQ(page->objects[0].key, "area/town.scan");
    EXPECT_EQ(page->objects[0].state, "\"70ee1738\"\n10\n2026-11-26T03:00:00.000Z");
    EXPECT_EQ(page->objects[1].key, "area/a & b <\xc3\xa4>.scan");
    EXPECT_EQ(page->objects[1].state, "\n3\n") << "nothing of the one before";
    EXPECT_EQ(page->next, "");
    const auto more =
        parseObjectPage(changed(onePage, "false<",
                                "true</IsTruncated><NextContinuationToken>1+/=</NextContinuationToken><X>"
                                "</X><IsTruncated>true<"));
    ASSERT_TRUE(more) << more.error().message;
    EXPECT_EQ(more->next, "1+/=");
    const auto none =
        parseObjectPage("<ListBucketResult><IsTruncated>false</IsTruncated></ListBucketResult>");
    ASSERT_TRUE(none);
    EXPECT_THAT(none->objects, IsEmpty());
}

// An answer that was cut off must never look like one that has fewer objects.
TEST(ObjectListTest, halfAnAnswerIsNone) {
    const std::size_t whole = onePage.find_last_of('>') + 1;
    for (std::size_t end = 0; end < whole; ++end)
        ASSERT_FALSE(parseObjectPage(onePage.substr(0, end))) << end;
    ASSERT_TRUE(parseObjectPage(onePage.substr(0, whole)));
}

TEST(ObjectListTest, whatIsNoListOfObjectsIsRefused) {
    for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
             {"<Name>", "<!DOCTYPE x [<!ENTITY y \"z\">]><Name>"},
             {"<Name>", "<!-- -->"},
             {"&amp;", "&y;"},
             {"&amp;", "&#0;"},
             {"&amp;", "&#xd800;"},
             {"&amp;", "&amp"},
             {"<Name>", "<Name <>"},
             {"</Name>", "</Nam>"},
             {"</Name>", ""},
             {"false", "no"},
             {"<IsTruncated>false</IsTruncated>", ""},
             {"false", "true"},
             {"<Key>area/town.scan</Key>", ""},
             {"<ListBucketResult xmlns", "<html xmlns"},
             {"</ListBucketResult>", "</ListBucketResult><ListBucketResult></ListBucketResult>"},
             {"</ListBucketResult>", "</ListBucketResult>x"},
             {"xmlns=\"http", "xmlns=\"\" x=\"http"},
         }) {
        const auto page = parseObjectPage(changed(onePage, from, to));
        if (from == "xmlns=\"http") continue;  // odd, and sound
        EXPECT_FALSE(page) << from << " -> " << to;
    }
    std::string deep = "<ListBucketResult>", many = "<ListBucketResult><IsTruncated>false</IsTruncated>";
    for (int i = 0; i < 100; ++i) deep += "<a>";
    EXPECT_FALSE(parseObjectPage(deep));
    for (int i = 0; i < 1001; ++i) many += "<Contents><Key>k</Key></Contents>";
    EXPECT_THAT(parseObjectPage(many + "</ListBucketResult>").error().message, HasSubstr("more objects"));
}

TEST(CloudListTest, aNameALineOrJson) {
    EXPECT_THAT(*parseCloudList("# clouds\r\n town.scan \r\n\nhttps://x.org/a.scan?b#c\n"),
                ElementsAre("town.scan", "https://x.org/a.scan?b#c"));
    EXPECT_THAT(*parseCloudList("\xef\xbb\xbftown.scan"), ElementsAre("town.scan"));
    EXPECT_THAT(*parseCloudList(R"(["a.scan", "b c.scan"])"), ElementsAre("a.scan", "b c.scan"));
    EXPECT_THAT(*parseCloudList(R"({"clouds": ["a.scan"], "more": 1})"), ElementsAre("a.scan"));
    EXPECT_THAT(*parseCloudList("town/ept.json\n"), ElementsAre("town/ept.json"));
    EXPECT_THAT(*parseCloudList("# none\n"), IsEmpty());
    EXPECT_THAT(*parseCloudList("[]"), IsEmpty());
    for (const std::string none : {"", " \n", "<html></html>", "[1]", "{}", "[",
                                   "Service unavailable\nSee http://x.org/ later\n", R"({"clouds": "a"})"})
        EXPECT_FALSE(parseCloudList(none)) << none;
    EXPECT_FALSE(parseCloudList(std::string("a\0b", 3)));
}

TEST(CloudListTest, aWordIsAUrlBesideTheList) {
    const auto list = *RemoteUrl::parse("https://x.org/clouds/list.txt?X-Amz-Signature=topsecret");
    const auto whole = [&](std::string_view word) {
        return urlIn(list, word).map([](const RemoteUrl& url) { return url.whole(); });
    };
    EXPECT_EQ(whole("town.scan"), "https://x.org/clouds/town.scan");
    EXPECT_EQ(whole("a b/t\xc3\xb6wn.scan"), "https://x.org/clouds/a%20b/t%C3%B6wn.scan");
    EXPECT_EQ(whole("/town%20x.scan?signed=1"), "https://x.org/town%20x.scan?signed=1");
    EXPECT_EQ(whole("https://other.org/a.scan"), "https://other.org/a.scan");
    for (const char* refused :
         {"", "../a.scan", "a/../b.scan", "http://x.org/a.scan", "s3://bucket/a.scan", "ftp://x.org/a.scan",
          "https://name:word@x.org/a.scan", "folder/", "a.scan#b"}) {
        EXPECT_FALSE(whole(refused)) << refused;
    }
    EXPECT_EQ(urlIn(*RemoteUrl::parse("http://x.org/l"), "http://y.org/a.scan")->whole(),
              "http://y.org/a.scan");
    const auto inS3 = *RemoteUrl::parse("s3://bucket/area/list");
    EXPECT_EQ(urlIn(inS3, "town x.scan")->whole(), "s3://bucket/area/town x.scan");
    EXPECT_EQ(urlIn(inS3, "/town.scan")->whole(), "s3://bucket/town.scan");
    EXPECT_EQ(urlIn(inS3, "s3://other/town.scan")->whole(), "s3://other/town.scan");
    EXPECT_FALSE(urlIn(inS3, "http://x.org/a.scan"));
}

TEST(RemoteAccessTest, asksABucketWhichObjectsThereAre) {
    const RemoteEnvironment environment{.keyId = "id", .secret = "topsecret", .region = "eu-central-1"};
    const auto first = accessTo(ListAsk{"scans", "a&b/"}, environment);
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_EQ(first->url,
              "https://scans.s3.eu-central-1.amazonaws.com/?delimiter=%2F&list-type=2&prefix=a%26b%2F");
    EXPECT_EQ(first->signing, "aws:amz:eu-central-1:s3");
    EXPECT_FALSE(first->mayRedirect);
    const auto dots = accessTo(ListAsk{"my.scans", ""}, environment);
    EXPECT_EQ(dots->url, "https://s3.eu-central-1.amazonaws.com/my.scans?delimiter=%2F&list-type=2&prefix=");
    const auto next = accessTo(ListAsk{"scans", "", "1+/="}, {.endpoint = "http://127.0.0.1:9000/"});
    EXPECT_EQ(next->url,
              "http://127.0.0.1:9000/scans?continuation-token=1%2B%2F%3D&delimiter=%2F&list-type=2&prefix=");
    EXPECT_FALSE(accessTo(ListAsk{"a?", ""}, environment));
}

TEST(RemoteListingTest, aListThatCannotBeHadIsAnErrorAndNoEmptyOne) {
    RangeServer server("town.scan\nbad\x01/\nchurch.scan\n");
    RemoteOptions options;
    options.transfers.limits.connect = options.transfers.limits.stall = std::chrono::milliseconds(2000);
    RemoteFiles remote(options);
    auto listing = RemoteListing::create(server.url("/list.txt") + "?topsecret");
    ASSERT_TRUE(listing) << listing.error().message;
    server.script([](int) { return RangeServer::Does::SendsAll; });
    const auto first = listing->look(remote);
    ASSERT_TRUE(first && *first) << first.error().message;
    ASSERT_EQ((*first)->clouds.size(), 2u);
    EXPECT_EQ((*first)->clouds[0].name, "church.scan") << "ordered by name";
    EXPECT_EQ((*first)->clouds[1].url, server.url("/town.scan"));
    EXPECT_EQ((*first)->leftOut.size(), 1u);
    EXPECT_THAT(server.lastHead(), ::testing::Not(HasSubstr("Range:")));
    const auto same = listing->look(remote);
    ASSERT_TRUE(same);
    EXPECT_FALSE(*same) << "as it was";
    for (const auto does :
         {RangeServer::Does::Answers404, RangeServer::Does::Answers403, RangeServer::Does::Answers503,
          RangeServer::Does::BreaksOff, RangeServer::Does::Hangs}) {
        server.script([does](int) { return does; });
        const auto none = listing->look(remote);
        ASSERT_FALSE(none) << int(does);
        EXPECT_THAT(none.error().message, HasSubstr("/list.txt: "));
        EXPECT_THAT(none.error().message, ::testing::Not(HasSubstr("topsecret")));
    }
    server.script([](int) { return RangeServer::Does::SendsAll; });
    server.replace("", "\"second\"");
    EXPECT_FALSE(listing->look(remote)) << "as it is while it is being written";
    server.replace("# none\n", "\"third\"");
    const auto empty = listing->look(remote);
    ASSERT_TRUE(empty && *empty);
    EXPECT_THAT((*empty)->clouds, IsEmpty());
    remote.stop();
    EXPECT_FALSE(listing->look(remote));
}

TEST(RemoteListingTest, whatIsAPrefixAndWhatIsAList) {
    EXPECT_EQ(RemoteListing::create("s3://scans")->shown(), "s3://scans/");
    EXPECT_EQ(RemoteListing::create("s3://scans/area/")->shown(), "s3://scans/area/");
    EXPECT_EQ(RemoteListing::create("s3://scans/area/list.txt")->shown(), "s3://scans/area/list.txt");
    EXPECT_EQ(RemoteListing::create("https://x.org/list?secret")->shown(), "https://x.org/list");
    for (const char* none : {"https://x.org/", "https://x.org", "s3://x", "s3:///a/", "ftp://x/y"})
        EXPECT_FALSE(RemoteListing::create(none)) << none;
}

}  // namespace
}  // namespace scancast::test
