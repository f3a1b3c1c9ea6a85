// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "places.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::support {

/// Two labs' folders as deploy/security/make.sh writes them, and room for what is made from them;
/// gone with the process.  Wants STILLHAND_SOURCE and STILLHAND_BUILD.
class SecurityFolders {
 public:
  static const SecurityFolders& get() {
    static const SecurityFolders folders;
    return folders;
  }
  [[nodiscard]] std::filesystem::path lab() const { return root_ / "lab"; }
  /// Same names throughout, another authority.
  [[nodiscard]] std::filesystem::path other() const { return root_ / "other"; }
  /// The lab's folder once more, to be altered.
  [[nodiscard]] std::filesystem::path copy_of_lab(const std::string& name) const {
    std::filesystem::remove_all(root_ / name);
    std::filesystem::copy(lab(), root_ / name, std::filesystem::copy_options::recursive);
    return root_ / name;
  }
  /// The private key of a folder's authority; of a copy, that of the lab.
  [[nodiscard]] std::filesystem::path authority_key(const std::filesystem::path& folder) const {
    const std::filesystem::path own = folder.string() + "-authority";
    const std::filesystem::path of = std::filesystem::exists(own) ? own : root_ / "lab-authority";
    return of / "authority_key.pem";
  }
  /// @throws std::runtime_error when it fails
  static void shell(const std::string& command) {
    if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
  }
  static void make(const std::filesystem::path& folder, const std::string& options = "") {
    shell("STILLHAND_BUILD=" STILLHAND_BUILD " " STILLHAND_SOURCE "/deploy/security/make.sh " +
          folder.string() + " " + options + " >/dev/null");
  }

 private:
  SecurityFolders() {
    make(lab());
    make(other());
  }
  const Folder root_;
};

/// Puts the certificate in the place of another, good from `from_s` to `to_s` [s] from now, and
/// signed by the folder's authority.
inline void reissue(const std::filesystem::path& folder, const std::string& identity, long from_s,
                    long to_s) {
  const auto open = [](const std::filesystem::path& path, const char* mode) {
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), mode),
                                                         std::fclose);
    if (file == nullptr) throw std::runtime_error("no file " + path.string());
    return file;
  };
  const std::filesystem::path path = folder / identity / "certificate.pem";
  const std::unique_ptr<X509, void (*)(X509*)> certificate(
      PEM_read_X509(open(path, "r").get(), nullptr, nullptr, nullptr), X509_free);
  const std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)> key(
      PEM_read_PrivateKey(open(SecurityFolders::get().authority_key(folder), "r").get(), nullptr,
                          nullptr, nullptr),
      EVP_PKEY_free);
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), from_s);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), to_s);
  if (X509_sign(certificate.get(), key.get(), EVP_sha256()) == 0) {
    throw std::runtime_error("cannot sign " + path.string());
  }
  PEM_write_X509(open(path, "w").get(), certificate.get());
}

}  // namespace stillhand::support
