// A TCP connection, in the clear or through TLS, as one type that Asio and Beast take for a stream. What lies
// below it is compiled once, in net_stream.cpp: handlers and buffers lose their types here.
//
// Owned by one connection; one strand, or one thread, and handlers run on its executor.
// Pipeline: socket → **net stream** → HTTP, WebSocket.
#pragma once

#include <utility>  // before Asio: Boost 1.74 forgets it

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <functional>
#include <memory>

namespace boost::asio::ssl {
class context;
}

namespace scancast {

/// Any completion handler of (error, bytes), also one that can only be moved. Called once.
class IoHandler {
  public:
    using ErrorCode = boost::system::error_code;
    template <class Handler>
    explicit IoHandler(Handler handler) : held_(std::make_unique<Held<Handler>>(std::move(handler))) {}
    void operator()(ErrorCode error, std::size_t bytes) { std::exchange(held_, nullptr)->run(error, bytes); }

  private:
    struct Base {
        virtual ~Base() = default;
        virtual void run(ErrorCode error, std::size_t bytes) = 0;
    };
    template <class Handler>
    struct Held final : Base {
        explicit Held(Handler h) : handler(std::move(h)) {}
        void run(ErrorCode error, std::size_t bytes) override { handler(error, bytes); }
        Handler handler;
    };
    std::unique_ptr<Base> held_;
};

class NetStream {
  public:
    using ErrorCode = boost::system::error_code;
    using executor_type = boost::beast::tcp_stream::executor_type;
    enum class Side : std::uint8_t { Client, Server };

    explicit NetStream(boost::beast::tcp_stream stream);
    /// Speaks TLS as the context says, which it keeps; nothing else may happen before handshake().
    NetStream(boost::beast::tcp_stream stream, std::shared_ptr<boost::asio::ssl::context> context);
    NetStream(NetStream&&) noexcept;
    NetStream& operator=(NetStream&&) noexcept;
    ~NetStream();

    /// The connection below, whose deadlines hold for everything.
    boost::beast::tcp_stream& tcp();
    executor_type get_executor() { return tcp().get_executor(); }

    template <class Buffers, class Handler>
    void async_read_some(const Buffers& buffers, Handler&& handler) {
        read(list<boost::asio::mutable_buffer>(buffers), IoHandler(std::forward<Handler>(handler)));
    }
    template <class Buffers, class Handler>
    void async_write_some(const Buffers& buffers, Handler&& handler) {
        write(list<boost::asio::const_buffer>(buffers), IoHandler(std::forward<Handler>(handler)));
    }
    /// TLS's greeting; in the clear there is none, and the handler is posted at once.
    void handshake(Side side, std::function<void(ErrorCode)> handler);
    /// TLS's goodbye, without which an answer looks cut short; in the clear as above.
    void goodbye(std::function<void(ErrorCode)> handler);
    /// Client, before the handshake: whose certificate it must be. False when OpenSSL refuses the name.
    bool expectHost(const std::string& host);

    // What Beast's WebSocket asks of a stream that it does not know.
    friend void beast_close_socket(NetStream& stream) { stream.tcp().close(); }
    friend void teardown(boost::beast::role_type role, NetStream& stream, ErrorCode& error) {
        stream.tearDown(role, error);
    }
    template <class Handler>
    friend void async_teardown(boost::beast::role_type role, NetStream& stream, Handler&& handler) {
        stream.asyncTearDown(role, IoHandler([handler = std::forward<Handler>(handler)](
                                                 ErrorCode error, std::size_t) mutable { handler(error); }));
    }

  private:
    // Messages come in a header and a body or two; what does not fit waits for the next call, as "some"
    // allows.
    static constexpr std::size_t mostBuffers = 8;
    template <class Buffer>
    using List = std::array<Buffer, mostBuffers>;

    template <class Buffer, class Buffers>
    static List<Buffer> list(const Buffers& buffers) {
        List<Buffer> list{};
        std::size_t count = 0;
        const auto end = boost::asio::buffer_sequence_end(buffers);
        for (auto at = boost::asio::buffer_sequence_begin(buffers); at != end && count < mostBuffers; ++at) {
            const Buffer one(*at);
            if (one.size() > 0) list[count++] = one;
        }
        return list;
    }
    void read(const List<boost::asio::mutable_buffer>& buffers, IoHandler handler);
    void write(const List<boost::asio::const_buffer>& buffers, IoHandler handler);
    void tearDown(boost::beast::role_type role, ErrorCode& error);
    void asyncTearDown(boost::beast::role_type role, IoHandler handler);

    struct Below;
    std::unique_ptr<Below> below_;
};

}  // namespace scancast
