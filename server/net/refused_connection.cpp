#include <utility>  // before Beast: Boost 1.74 forgets it

#include "server/net/refused_connection.hpp"

#include <fmt/format.h>

#include <array>
#include <boost/asio/dispatch.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include "server/net/api/handler.hpp"

namespace scancast {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::seconds refusedPatience{2};
// Requests that come behind the answer; a socket that is closed with unread ones resets, and takes the answer with it.
constexpr std::size_t mostUnheard = 64 * 1024;
// Beyond, those who are refused lose that: it is for them, and costs files.
constexpr std::size_t mostLingering = 64;

class RefusedConnection final : public std::enable_shared_from_this<RefusedConnection> {
  public:
    RefusedConnection(asio::ip::tcp::socket socket, NetContext& context)
        : stream_(std::move(socket)), context_(context) {
        context_.refusedLingering.fetch_add(1);
    }
    ~RefusedConnection() { context_.refusedLingering.fetch_sub(1); }

    void run(const std::string& answer) {
        error_code ignored;
        auto& socket = stream_.socket();
        socket.non_blocking(true, ignored);  // whoever has just connected has room for it, or does without
        std::ignore = socket.send(asio::buffer(answer), 0, ignored);
        socket.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
        stream_.expires_after(refusedPatience);
        asio::dispatch(stream_.get_executor(),
                       Handler(shared_from_this(), [](RefusedConnection& self) { self.discard(); }));
    }
    void fault() noexcept {}  // it ends by itself

  private:
    void discard() {
        stream_.async_read_some(
            asio::buffer(unheard_),
            Handler(shared_from_this(), [](RefusedConnection& self, error_code ec, std::size_t bytes) {
                self.heard_ += bytes;
                if (!ec && self.heard_ < mostUnheard) self.discard();
            }));
    }

    boost::beast::tcp_stream stream_;
    NetContext& context_;
    std::array<char, 2048> unheard_{};
    std::size_t heard_ = 0;
};

std::string refusalText(const HttpResponse& response) {
    std::string text = fmt::format("HTTP/1.1 {} {}\r\n", response.status, reasonPhrase(response.status));
    for (const auto& [name, value] : response.headers) text += name + ": " + value + "\r\n";
    return text + fmt::format("Content-Length: {}\r\nConnection: close\r\n\r\n", response.text.size()) +
           response.text;
}

}  // namespace

HttpResponse refusalResponse(ConnectionRefusal why, const ConnectionLimits& limits) {
    Problem problem = problemOf(503, "The server is shutting down; try again later.");
    if (why == ConnectionRefusal::Full) {
        problem = problemOf(503, fmt::format("All {} connections of this server are in use. Try again in a "
                                             "moment; --max-connections allows more.",
                                             limits.all));
    }
    if (why == ConnectionRefusal::Address) {
        problem = problemOf(
            429, fmt::format(
                     "{} connections come from your address, and all are in use; close one, or try again in "
                     "a moment. --max-connections-per-address allows more, and --trusted-proxy tells "
                     "clients behind a proxy apart.",
                     limits.perClient));
    }
    HttpResponse response = problemResponse(problem);
    response.set("Retry-After", "1");
    return response;
}

void refuseConnection(asio::ip::tcp::socket socket, std::string client, ConnectionRefusal why,
                      NetContext& context, Entrance entrance) {
    HttpResponse response = refusalResponse(why, context.registerOf(entrance).limits());
    RequestRecord record;
    record.ids = RequestIds::of({}, {});
    record.client = std::move(client);
    record.status = response.status;
    const bool silently = context.tlsOf(entrance) != nullptr || context.refusedLingering >= mostLingering;
    if (silently) record.note = "closed without a word";
    context.requestLog.add(record);
    if (silently) return;
    std::make_shared<RefusedConnection>(std::move(socket), context)
        ->run(refusalText(response.identify(record.ids)));
}

}  // namespace scancast
