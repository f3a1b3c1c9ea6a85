// SPDX-License-Identifier: Apache-2.0
#include "services/bus/identity.hpp"

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>

#include <algorithm>
#include <memory>
#include <regex>

#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {
namespace {

namespace fs = std::filesystem;

constexpr int kWarnDays = 30;
constexpr const char* kMaker = "a folder written by deploy/security/make.sh";

template <auto Free>
struct Freed {
  template <typename T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Bytes = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Store = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using Verification = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;
using Subject = std::unique_ptr<X509_NAME, Freed<X509_NAME_free>>;
using Signed = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;

Bytes opened(const fs::path& file) {
  // Nothing that would be waited for, such as a pipe.
  std::error_code ignored;
  Bytes bytes(std::filesystem::is_regular_file(file, ignored) ? BIO_new_file(file.c_str(), "r")
                                                              : nullptr);
  if (bytes == nullptr) throw ConfigError("security", "no readable " + file.string(), kMaker);
  return bytes;
}

Certificate certificate_in(const fs::path& file) {
  Certificate certificate(PEM_read_bio_X509(opened(file).get(), nullptr, nullptr, nullptr));
  if (certificate == nullptr)
    throw ConfigError(file.string(), "no certificate", "a certificate in PEM");
  return certificate;
}

/// The text that OpenSSL wrote into memory.
std::string text_of(BIO& memory) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(&memory, &bytes);
  return {bytes, static_cast<std::size_t>(size)};
}

std::string time_text(const ASN1_TIME* time) {
  const Bytes memory(BIO_new(BIO_s_mem()));
  ASN1_TIME_print(memory.get(), time);
  return text_of(*memory);
}

/// As the permissions name it.
std::string subject_of(X509& certificate) {
  const Bytes memory(BIO_new(BIO_s_mem()));
  X509_NAME_print_ex(memory.get(), X509_get_subject_name(&certificate), 0, XN_FLAG_RFC2253);
  return text_of(*memory);
}

void verify(const Identity& identity, X509& certificate, X509_STORE& authority) {
  const Verification verification(X509_STORE_CTX_new());
  X509_STORE_CTX_init(verification.get(), &authority, &certificate, nullptr);
  if (X509_verify_cert(verification.get()) == 1) return;
  const int error = X509_STORE_CTX_get_error(verification.get());
  const bool its_own = X509_STORE_CTX_get_error_depth(verification.get()) == 0;
  const fs::path file = its_own ? identity.own_file("certificate.pem") : identity.authority_file();
  const X509* named = X509_STORE_CTX_get_current_cert(verification.get());
  if (error == X509_V_ERR_CERT_HAS_EXPIRED) {
    throw ConfigError(file.string(),
                      "a certificate that expired on " + time_text(X509_get0_notAfter(named)),
                      "a valid one: make a new folder with deploy/security/make.sh");
  }
  if (error == X509_V_ERR_CERT_NOT_YET_VALID) {
    throw ConfigError(file.string(),
                      "a certificate not valid before " + time_text(X509_get0_notBefore(named)),
                      "a valid one, or a correct clock of this machine");
  }
  throw ConfigError(file.string(),
                    std::string("a certificate that cannot be verified (") +
                        X509_verify_cert_error_string(error) + ")",
                    "a certificate of the authority in " + identity.authority_file().string());
}

/// The text of a document that the authority signed.
std::string signed_text(const fs::path& file, X509_STORE& authority, const Identity& identity) {
  BIO* content = nullptr;
  const Signed document(SMIME_read_PKCS7(opened(file).get(), &content));
  const Bytes detached(content);
  const Bytes text(BIO_new(BIO_s_mem()));
  if (document == nullptr ||
      PKCS7_verify(document.get(), nullptr, &authority, content, text.get(), PKCS7_TEXT) != 1) {
    ERR_clear_error();
    throw ConfigError(
        file.string(), "a document with no valid signature",
        "a document signed by the authority in " + identity.authority_file().string());
  }
  return text_of(*text);
}

// A key that others on the machine read is theirs, too.  A group may: that of the lab's users.
void check_private(const fs::path& file) {
  constexpr fs::perms kOthers = fs::perms::others_read | fs::perms::others_write;
  if ((fs::status(file).permissions() & kOthers) == fs::perms::none) return;
  throw ConfigError(file.string(),
                    "a private key that every user of this machine may read or write",
                    "chmod o= " + file.string());
}

void check_domain(const fs::path& file, const std::string& text, std::uint32_t domain) {
  static const std::regex range("<min>([0-9]{1,3})</min>\\s*<max>([0-9]{1,3})</max>");
  std::smatch match;
  if (!std::regex_search(text, match, range)) {
    throw ConfigError(file.string(), "no range of domains", kMaker);
  }
  if (domain < std::stoul(match[1]) || domain > std::stoul(match[2])) {
    throw ConfigError(
        "domain", std::to_string(domain),
        match[1].str() + " to " + match[2].str() + ", the domains of " + file.string());
  }
}

}  // namespace

Identity Identity::of(const fs::path& folder, const std::string& service) {
  const bool known = std::find(topics::kServices.begin(), topics::kServices.end(), service) !=
                     topics::kServices.end();
  if (known) return {folder, service};
  // A dashboard's name ends in a number of its own.
  return {folder,
          std::string(service.starts_with(topics::kDashboard) ? topics::kDashboard : topics::kTap)};
}

fs::path Identity::authority_file() const { return folder / "authority.pem"; }

fs::path Identity::governance_file() const { return folder / "governance.p7s"; }

fs::path Identity::own_file(const char* file) const { return folder / name / file; }

void check_identity(const Identity& identity, std::uint32_t domain) {
  const Certificate authority = certificate_in(identity.authority_file());
  const Store store(X509_STORE_new());
  X509_STORE_add_cert(store.get(), authority.get());

  const Certificate certificate = certificate_in(identity.own_file("certificate.pem"));
  verify(identity, *certificate, *store);

  const fs::path key_file = identity.own_file("key.pem");
  // A service has no terminal to ask for a password.
  const auto no_password = [](char*, int, int, void*) { return -1; };
  const Key key(PEM_read_bio_PrivateKey(opened(key_file).get(), nullptr, no_password, nullptr));
  if (key == nullptr || X509_check_private_key(certificate.get(), key.get()) != 1) {
    ERR_clear_error();
    throw ConfigError(key_file.string(), "the key of another certificate",
                      "the key of " + identity.own_file("certificate.pem").string());
  }
  check_private(key_file);

  const fs::path governance = identity.governance_file();
  check_domain(governance, signed_text(governance, *store, identity), domain);
  const fs::path permissions = identity.own_file("permissions.p7s");
  const std::string rights = signed_text(permissions, *store, identity);
  check_domain(permissions, rights, domain);
  const std::string subject = subject_of(*certificate);
  if (rights.find("<subject_name>" + subject + "</subject_name>") == std::string::npos) {
    throw ConfigError(permissions.string(), "permissions of another subject",
                      "those of \"" + subject + "\"");
  }
}

std::string expiry_warning(const Identity& identity) {
  const fs::path file = identity.own_file("certificate.pem");
  const Certificate certificate = certificate_in(file);
  int days = 0;
  int seconds = 0;
  ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate.get()));
  if (days >= kWarnDays) return "";
  return file.string() + " expires on " + time_text(X509_get0_notAfter(certificate.get())) +
         ": make a new folder with deploy/security/make.sh before that date";
}

std::array<std::uint8_t, 6> guid_start(const Identity& identity) {
  return guid_start(identity, identity.name);
}

std::array<std::uint8_t, 6> guid_start(const Identity& identity, const std::string& name) {
  const Certificate certificate = certificate_in(identity.own_file("certificate.pem"));
  const Subject subject(X509_NAME_dup(X509_get_subject_name(certificate.get())));
  if (name != identity.name) {
    const int place = X509_NAME_get_index_by_NID(subject.get(), NID_commonName, -1);
    X509_NAME_ENTRY_free(X509_NAME_delete_entry(subject.get(), place));
    X509_NAME_add_entry_by_NID(subject.get(), NID_commonName, MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(name.c_str()), -1, place, 0);
  }
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  X509_NAME_digest(subject.get(), EVP_sha256(), digest.data(), &size);
  std::array<std::uint8_t, 6> start{};
  std::uint8_t carried = 1;  // one set bit, then 47 of the digest
  for (std::size_t i = 0; i < start.size(); ++i) {
    start[i] = static_cast<std::uint8_t>((carried << 7) | (digest[i] >> 1));
    carried = digest[i] & 1;
  }
  return start;
}

}  // namespace stillhand::runtime
