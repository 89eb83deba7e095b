#include "server/net/tls/ticket_keys.hpp"

#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/params.h>
#include <openssl/rand.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <cstring>
#include <memory>

namespace scancast {
namespace {

using Clock = std::chrono::steady_clock;

void deleteKeys(void*, void* keys, CRYPTO_EX_DATA*, int, long, void*) {
    delete static_cast<TicketKeys*>(keys);
}

int keysIndex() {
    static const int index = SSL_CTX_get_ex_new_index(0, nullptr, nullptr, nullptr, deleteKeys);
    return index;
}

bool setMac(EVP_MAC_CTX* mac, TicketKey& key) {
    char digest[] = "SHA256";
    const OSSL_PARAM parameters[] = {
        OSSL_PARAM_construct_octet_string(OSSL_MAC_PARAM_KEY, key.mac.data(), key.mac.size()),
        OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_DIGEST, digest, 0), OSSL_PARAM_construct_end()};
    return EVP_MAC_CTX_set_params(mac, parameters) == 1;
}

// As SSL_CTX_set_tlsext_ticket_key_evp_cb(3) has it: 0 = no ticket, or one that is of no use, and the handshake goes on.
int seal(TicketKeys& keys, unsigned char* name, unsigned char* iv, EVP_CIPHER_CTX* cipher, EVP_MAC_CTX* mac) {
    auto key = keys.sealing(Clock::now());
    if (!key || RAND_bytes(iv, EVP_CIPHER_get_iv_length(EVP_aes_256_cbc())) != 1) return 0;
    std::ranges::copy(key->name, name);
    const bool ready = EVP_EncryptInit_ex(cipher, EVP_aes_256_cbc(), nullptr, key->cipher.data(), iv) == 1 &&
                       setMac(mac, *key);
    return ready ? 1 : 0;
}

int open(TicketKeys& keys, const unsigned char* name, const unsigned char* iv, EVP_CIPHER_CTX* cipher,
         EVP_MAC_CTX* mac) {
    auto key = keys.opening(std::span<const unsigned char, 16>(name, 16), Clock::now());
    if (!key) return 0;
    const bool ready = setMac(mac, *key) &&
                       EVP_DecryptInit_ex(cipher, EVP_aes_256_cbc(), nullptr, key->cipher.data(), iv) == 1;
    return ready ? 1 : 0;
}

int onTicket(SSL* connection, unsigned char* name, unsigned char* iv, EVP_CIPHER_CTX* cipher,
             EVP_MAC_CTX* mac, int seals) {
    auto* keys = static_cast<TicketKeys*>(SSL_CTX_get_ex_data(SSL_get_SSL_CTX(connection), keysIndex()));
    if (keys == nullptr) return 0;
    return seals != 0 ? seal(*keys, name, iv, cipher, mac) : open(*keys, name, iv, cipher, mac);
}

}  // namespace

TicketKey::~TicketKey() {
    OPENSSL_cleanse(cipher.data(), cipher.size());
    OPENSSL_cleanse(mac.data(), mac.size());
}

std::optional<TicketKey> TicketKeys::sealing(Time now) {
    const std::lock_guard lock(mutex_);
    if (current_ && now - current_->made < life) return current_;
    TicketKey fresh;
    fresh.made = now;
    for (const std::span<unsigned char> part :
         {std::span<unsigned char>(fresh.name), std::span<unsigned char>(fresh.cipher),
          std::span<unsigned char>(fresh.mac)})
        if (RAND_bytes(part.data(), int(part.size())) != 1) return std::nullopt;
    previous_ = std::move(current_);
    current_ = fresh;
    return current_;
}

std::optional<TicketKey> TicketKeys::opening(std::span<const unsigned char, 16> name, Time now) {
    const std::lock_guard lock(mutex_);
    for (auto* key : {&current_, &previous_}) {
        if (*key && now - (*key)->made >= 2 * life) key->reset();  // nobody came for a long time
        if (*key && std::ranges::equal((*key)->name, name)) return *key;
    }
    return std::nullopt;
}

Expected<void> sealTicketsOf(SSL_CTX& context) {
    auto keys = std::make_unique<TicketKeys>();
    if (keysIndex() < 0 || SSL_CTX_set_ex_data(&context, keysIndex(), keys.get()) != 1 ||
        SSL_CTX_set_tlsext_ticket_key_evp_cb(&context, onTicket) != 1)
        return fail(ErrorCode::Internal, "OpenSSL cannot make tickets for sessions.");
    keys.release();  // the context's
    SSL_CTX_set_timeout(&context, long(std::chrono::seconds(TicketKeys::life).count()));
    return {};
}

}  // namespace scancast
