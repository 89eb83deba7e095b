#include "server/commands/doctor/listening_process.hpp"

#include <gtest/gtest.h>

namespace scancast {
namespace {

// As Linux writes it; 1F90 is 8080, and 0A a socket that listens.
TEST(ListeningInodes, AreThoseOfThePortThatListen) {
    const std::string table =
        "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n"
        "   0: 0100007F:1F90 00000000:0000 0A 00000000:00000000 00:00000000 00000000  1000        0 4711 1 0 "
        "100 0 0 10 0\n"
        "   1: 0100007F:1F90 0100007F:C350 01 00000000:00000000 00:00000000 00000000  1000        0 4712 1 0 "
        "20 4 30 10 -1\n"
        "   2: 00000000:0016 00000000:0000 0A 00000000:00000000 00:00000000 00000000     0        0 4713 1 0 "
        "100 0 0 10 0\n"
        "   3: 00000000000000000000000001000000:1F90 00000000000000000000000000000000:0000 0A "
        "00000000:00000000 "
        "00:00000000 00000000  1000        0 4714 1 0 100 0 0 10 0\n"
        "   4: cut off\n";
    EXPECT_EQ(listeningInodes(table, 8080), (std::vector<std::uint64_t>{4711, 4714}));
    EXPECT_EQ(listeningInodes(table, 22), (std::vector<std::uint64_t>{4713}));
    EXPECT_TRUE(listeningInodes(table, 50000).empty());
    EXPECT_TRUE(listeningInodes("", 8080).empty());
}

}  // namespace
}  // namespace scancast
