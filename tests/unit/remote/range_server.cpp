#include "tests/unit/remote/range_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

namespace scancast::test {

RangeServer::RangeServer(std::string content) : content_(std::move(content)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener_, 64) != 0 ||
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
        std::abort();
    port_ = ntohs(address.sin_port);
    acceptor_ = std::thread([this] { accept(); });
}

RangeServer::~RangeServer() {
    stopping_ = true;
    ::shutdown(listener_, SHUT_RDWR);
    acceptor_.join();
    ::close(listener_);
    std::vector<std::thread> threads;
    {
        const std::lock_guard lock(mutex_);
        for (const int one : connections_) ::shutdown(one, SHUT_RDWR);
        threads = std::move(threads_);
    }
    for (std::thread& thread : threads) thread.join();
    for (const int one : connections_) ::close(one);
}

std::string RangeServer::url(const std::string& path) const {
    return fmt::format("http://127.0.0.1:{}{}", port_, path);
}

void RangeServer::script(Script script) {
    const std::lock_guard lock(mutex_);
    script_ = std::move(script);
}

void RangeServer::replace(std::string content, std::string etag) {
    const std::lock_guard lock(mutex_);
    content_ = std::move(content);
    etag_ = std::move(etag);
}

void RangeServer::others(std::string path, std::map<std::string, std::string> contents) {
    const std::lock_guard lock(mutex_);
    path_ = std::move(path);
    others_ = std::move(contents);
}

void RangeServer::refuse(std::string path) {
    const std::lock_guard lock(mutex_);
    refused_ = std::move(path);
}

int RangeServer::requests(const std::string& path) const {
    const std::lock_guard lock(mutex_);
    const auto at = asked_.find(path);
    return at == asked_.end() ? 0 : at->second;
}

std::string RangeServer::lastHead() const {
    const std::lock_guard lock(mutex_);
    return head_;
}

void RangeServer::accept() {
    while (!stopping_) {
        const int connection = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
        if (connection < 0) continue;
        const std::lock_guard lock(mutex_);
        connections_.push_back(connection);
        threads_.emplace_back([this, connection] { serve(connection); });
    }
}

void RangeServer::serve(int connection) {
    std::string read;
    for (bool close = false; !close && !stopping_;) {
        char space[4096];
        const ssize_t got = away_ ? 0 : ::recv(connection, space, sizeof space, 0);
        if (got <= 0) break;
        read.append(space, std::size_t(got));
        const auto end = read.find("\r\n\r\n");
        if (end == read.npos) continue;
        const std::string head = read.substr(0, end + 2);
        read.erase(0, end + 4);
        if (away_) break;
        bool drips = false;
        const std::string said = answer(head, close, drips);
        for (std::size_t sent = 0; sent < said.size() && !stopping_;) {
            if (drips) std::this_thread::sleep_for(std::chrono::milliseconds(20));
            const ssize_t some =
                ::send(connection, said.data() + sent, drips ? 1 : said.size() - sent, MSG_NOSIGNAL);
            if (some <= 0) break;
            sent += std::size_t(some);
        }
    }
    ::shutdown(connection, SHUT_RDWR);
}

std::string RangeServer::answer(const std::string& head, bool& close, bool& drips) {
    const std::lock_guard lock(mutex_);
    const int number = requests_++;
    head_ = head;
    const std::string path = head.substr(4, head.find_first_of(" ?", 4) - 4);
    ++asked_[path];
    const Does does = script_ ? script_(number) : Does::Well;
    const auto plain = [](int status, const std::string& more, const std::string& body) {
        return fmt::format("HTTP/1.1 {} Said\r\n{}Content-Length: {}\r\n\r\n{}", status, more, body.size(),
                           body);
    };
    if (!refused_.empty() && path == refused_) return plain(403, "", "<Code>AccessDenied</Code>");
    if (does == Does::Answers503) return plain(503, "Retry-After: 0\r\n", "");
    if (does == Does::Answers404) return plain(404, "", "no");
    if (does == Does::Answers403)
        return plain(
            403, "",
            "<?xml version=\"1.0\"?><Error><Code>AccessDenied</Code><Message>a secret</Message></Error>");
    if (does == Does::Redirects && head.find("GET /moved ") == head.npos)
        return plain(302, "Location: /moved\r\n", "");
    if (does == Does::Hangs) return close = true, std::string();
    if (does == Does::Silent) return {};
    drips = does == Does::Drips;
    if (!path_.empty() && path != path_) {
        const auto other = others_.find(path);
        if (other == others_.end()) return plain(404, "", "no");
        std::string all = plain(200, "ETag: \"other\"\r\n", other->second);
        if (does == Does::BreaksOff) close = true, all.resize(all.size() - other->second.size() / 2 - 1);
        return all;
    }
    if (const auto at = head.find("If-Match: ");
        at != head.npos && head.substr(at + 10, etag_.size()) != etag_)
        return plain(412, "", "");
    const auto at = head.find("Range: bytes=");
    if (at == head.npos || does == Does::SendsAll) {
        std::string all = plain(200, fmt::format("ETag: {}\r\n", etag_), content_);
        if (does == Does::BreaksOff) close = true, all.resize(all.size() - content_.size() / 2 - 1);
        return all;
    }
    char* rest = nullptr;
    std::size_t first = std::strtoull(head.c_str() + at + 13, &rest, 10);
    std::size_t last = std::min<std::size_t>(std::strtoull(rest + 1, nullptr, 10), content_.size() - 1);
    if (does == Does::SendsOthers) first += 1, last = std::min(last + 1, content_.size() - 1);
    if (does == Does::SendsLess && last > first) --last;
    std::string more =
        fmt::format("ETag: {}\r\nContent-Range: bytes {}-{}/{}\r\n", etag_, first, last, content_.size());
    if (does == Does::Compresses) more += "Content-Encoding: gzip\r\n";
    std::string body = content_.substr(first, last - first + 1);
    if (does == Does::SendsMore) {
        close = true;
        return "HTTP/1.1 206 Said\r\n" + more + "\r\n" + body + std::string(1 << 20, 'x');
    }
    std::string said = plain(206, more, body);
    if (does == Does::BreaksOff) close = true, said.resize(said.size() - body.size() / 2 - 1);
    return said;
}

}  // namespace scancast::test
