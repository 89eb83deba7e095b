#include <utility>  // before Asio: Boost 1.74 forgets it

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <chrono>

#include "server/commands/doctor/checks.hpp"
#include "server/commands/doctor/listening_process.hpp"
#include "server/net/listener.hpp"
#include "server/net/tls/tls.hpp"

namespace scancast {
namespace {

void lookAtPort(const ListenAddress& address, Entrance entrance, Findings& findings) {
    boost::asio::io_context io;
    const auto acceptor = listenAt(io.get_executor(), address, entrance);
    const char* const flag = entrance == Entrance::Public ? "--port" : "--admin-listen";
    if (acceptor)
        return findings.ok(
            "listens", address.port == 0 ? address.host + " has a free port" : address.text() + " is free");
    if (acceptor.error().code != ErrorCode::Io)
        return findings.fault("listens", acceptor.error().message, "127.0.0.1 is always there");
    const auto other = listeningProcess(address.port);
    if (!other)
        return findings.fault("listens", acceptor.error().message,
                              fmt::format("{} names another one; ss -ltnp as root says who has it", flag));
    const std::string who =
        fmt::format("{} listens at {} (process {})", other->name, address.text(), other->id);
    if (other->name == "scancast")
        return findings.warning("listens", who,
                                fmt::format("nothing, if that is the server that is meant; else {}", flag));
    findings.fault("listens", who, fmt::format("end it, or {} names another port", flag));
}

void lookAtTokens(const ServeOptions& options, Findings& findings) {
    const auto tokens = accessTokens(options);
    if (!tokens)
        return findings.fault(
            "tokens", tokens.error().message,
            "umask 077; scancast token NAME > FILE makes a good one that only you may read");
    if (!tokens->users.empty() || !tokens->admins.empty())
        findings.ok("tokens", fmt::format("{} of users, {} of administrators", tokens->users.size(),
                                          tokens->admins.size()));
    if (!tokens->users.empty()) return;
    if (isLoopbackHost(options.server.host))
        return findings.ok("tokens", "none are needed to look, by who is on this machine");
    findings.warning("tokens",
                     fmt::format("everybody who can reach {} may see the clouds", options.server.host),
                     "--auth-token-file FILE");
}

void lookAtCertificate(const ServeOptions& options, Findings& findings) {
    const TlsFiles& files = options.server.tls;
    if (!files.given()) {
        if (isLoopbackHost(options.server.host))
            return findings.ok("certificate", "none; only this machine comes to " + options.server.host);
        return findings.warning("certificate",
                                "none: tokens and pictures can be read on the way to " + options.server.host,
                                "--tls-cert and --tls-key, or a proxy that has TLS (deploy/nginx)");
    }
    const auto tls = openTls(files);
    if (!tls)
        return findings.fault("certificate", tls.error().message,
                              "both files in PEM format, the key for its owner alone (chmod 600)");
    const std::string warning = expiryWarning(*tls, files.certificate, std::chrono::system_clock::now());
    if (!warning.empty())
        return findings.warning("certificate", warning, "renew it, then SIGHUP to the server");
    findings.ok("certificate", "good until " + dateText(tls->expires));
}

}  // namespace

void lookAtEntrances(const ServeOptions& options, Findings& findings) {
    lookAtPort({options.server.host, options.server.port}, Entrance::Public, findings);
    if (const auto probes = adminListen(options); probes && *probes)
        lookAtPort(**probes, Entrance::Probes, findings);
    lookAtTokens(options, findings);
    lookAtCertificate(options, findings);
}

}  // namespace scancast
