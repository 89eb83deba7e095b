// Allocations that fail while a request is answered, each in turn, on whichever of the server's threads: the
// client gets an answer or the end of its connection, nothing is left behind, and the next one is served.
// Small allocations are let through, as by the reserve that `serve` keeps
// (server/base/memory_reserve.hpp): destructors of Asio's strands and of JSON values must have them.
#include "tests/integration/server_fixture.hpp"
#include "tests/support/failing_allocation.hpp"

namespace scancast::test {
namespace {

class NoMemory : public ServerTest {
  protected:
    /// Does `ask` with the first, the second, ... allocation of at least that many bytes failing, until none
    /// does; returns how many did.
    template <class Ask>
    std::uint64_t failEach(std::size_t notSmall, Ask ask) {
        ask();  // what is allocated once and for all has been
        std::uint64_t nth = 0;
        for (bool happened = true; happened; ++nth) {
            {
                const FailingAllocation fails(nth + 1, notSmall);
                ask();
                happened = fails.happened();
            }
            EXPECT_TRUE(nobodyIsLeft()) << "when allocation " << nth + 1 << " failed";
            EXPECT_EQ(request(port(), "/healthz").status, 200) << nth + 1;
            if (HasFailure()) break;
        }
        return nth - 1;
    }
    bool nobodyIsLeft() const {
        return eventually([this] { return server->connections() == 0 && server->drained(); });
    }
};

TEST_F(NoMemory, ForASnapshot) {
    start();
    int answered = 0;
    const auto failures = failEach(512, [&] {
        const int status =
            request(port(), "/api/v1/clouds/one/snapshot.jpg?width=16&height=8", {"Connection: close"})
                .status;
        EXPECT_TRUE(status == 0 || status == 200 || status == 413 || status == 500 || status == 503)
            << status;
        answered += status != 0;
    });
    EXPECT_GT(failures, 10U);
    EXPECT_GT(answered, int(failures / 2)) << "most requests that fail are told why";
}

TEST_F(NoMemory, ForAStream) {
    start();
    const auto failures = failEach(1100, [&] {
        StreamClient client(port());
        if (client.greet().is_null()) return;
        client.view(1, 3);
        client.say({{"type", "ping"}, {"id", 7}});
        client.control("pong");
    });
    EXPECT_GT(failures, 5U);
}

}  // namespace
}  // namespace scancast::test
