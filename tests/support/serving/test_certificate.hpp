// Certificates for tests: made on the spot, self-signed, for localhost and 127.0.0.1.
#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <cstdio>
#include <filesystem>
#include <memory>

namespace scancast::test {

struct CertificateFiles {
    std::filesystem::path certificate, key;
};

enum class KeyKind : std::uint8_t { Curve, Rsa };

/// Writes NAME.crt and NAME.key into the folder. Valid from `from` to `until`, seconds from now.
inline CertificateFiles makeCertificate(const std::filesystem::path& folder, const std::string& name,
                                        long from = -60, long until = 3600, KeyKind kind = KeyKind::Curve) {
    const std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)> key(
        kind == KeyKind::Rsa ? EVP_RSA_gen(2048) : EVP_EC_gen("P-256"), EVP_PKEY_free);
    const std::unique_ptr<X509, void (*)(X509*)> certificate(X509_new(), X509_free);
    X509* x = certificate.get();
    X509_set_version(x, 2);
    ASN1_INTEGER_set(X509_get_serialNumber(x), 1);
    X509_gmtime_adj(X509_getm_notBefore(x), from);
    X509_gmtime_adj(X509_getm_notAfter(x), until);
    X509_set_pubkey(x, key.get());
    X509_NAME_add_entry_by_txt(X509_get_subject_name(x), "CN", MBSTRING_ASC,
                               reinterpret_cast<const unsigned char*>("localhost"), -1, -1, 0);
    X509_set_issuer_name(x, X509_get_subject_name(x));
    const auto extend = [&](int nid, const char* value) {
        X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, nullptr, nid, value);
        X509_add_ext(x, extension, -1);
        X509_EXTENSION_free(extension);
    };
    extend(NID_subject_alt_name, "DNS:localhost,IP:127.0.0.1");
    extend(NID_basic_constraints, "critical,CA:TRUE");
    X509_sign(x, key.get(), EVP_sha256());

    CertificateFiles files{folder / (name + ".crt"), folder / (name + ".key")};
    if (std::FILE* file = std::fopen(files.certificate.c_str(), "w")) {
        PEM_write_X509(file, x);
        std::fclose(file);
    }
    if (std::FILE* file = std::fopen(files.key.c_str(), "w")) {
        PEM_write_PrivateKey(file, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
        std::fclose(file);
    }
    ::chmod(files.key.c_str(), 0600);
    return files;
}

}  // namespace scancast::test
