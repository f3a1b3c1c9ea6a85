#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Creates a lab's authority, a key, a certificate and signed permissions for each service, and the signed governance:
# every file that `--security DIR` reads (deploy/security/README.md).  The authority's private key, which no service
# reads, goes into DIR-authority.
# Usage: deploy/security/make.sh DIR [--days N] [--lab NAME] [--domain N]
#   DIR       new folder; it must not exist
#   --days    validity of the certificates [days], default 365
#   --lab     organisation of the authority, default "stillhand"
#   --domain  the only DDS domain for which they are valid; default: every domain
set -euo pipefail

fail() { echo "make.sh: $1" >&2; exit "${2:-2}"; }

dir= days=365 lab=stillhand first=0 last=232
while [ $# -gt 0 ]; do
  case $1 in
    --days|--lab|--domain) [ $# -ge 2 ] || fail "$1: got nothing, want a value" ;;&
    --days) days=$2; shift ;;
    --lab) lab=$2; shift ;;
    --domain) first=$2 last=$2; shift ;;
    -*) fail "got $1, want DIR [--days N] [--lab NAME] [--domain N]" ;;
    *) [ -z "$dir" ] || fail "got two folders, $dir and $1, want one"; dir=$1 ;;
  esac
  shift
done
[ -n "$dir" ] || fail "got no folder, want DIR [--days N] [--lab NAME] [--domain N]"
[[ $days =~ ^[1-9][0-9]{0,3}$ ]] || fail "--days: got $days, want 1 to 9999"
# Characters that need no quotes in a certificate's name.
[[ $lab =~ ^[A-Za-z0-9._-]{1,64}$ ]] || fail "--lab: got $lab, want 1 to 64 letters, digits and . _ -"
[[ $first =~ ^(0|[1-9][0-9]{0,2})$ ]] && [ "$first" -le 232 ] || fail "--domain: got $first, want 0 to 232"
dir=${dir%/}
for each in "$dir" "$dir-authority"; do
  [ ! -e "$each" ] || fail "$each: got a folder that exists, want a new one"
done
parent=$(dirname "$dir")
[ -w "$parent" ] || fail "$parent: got no folder that can be written, want one in which $(basename "$dir") can be made"
command -v openssl >/dev/null || fail "got no openssl, want it installed (deploy/setup.sh installs it)"
# In the build tree, or in bin of the prefix that holds share/stillhand/deploy/security.
shipped=$(cd "$(dirname "$0")/../.." && pwd)
for prefix in "${STILLHAND_BUILD:-$shipped/build}" "$shipped/../.."; do
  permissions=$prefix/bin/stillhand-permissions
  [ ! -x "$permissions" ] || break
done
[ -x "$permissions" ] ||
  fail "got no stillhand-permissions in ${STILLHAND_BUILD:-$shipped/build}/bin, want it built (deploy/build.sh)"

umask 077
made=$(mktemp -d "$parent/.stillhand-security.XXXXXX")
trap 'rm -rf "$made"' EXIT
log=$made/log
quietly() { "$@" >"$log" 2>&1 || fail "$1 failed: $(tail -n 1 "$log")" 1; }
new_key() { quietly openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out "$1"; }
signed() {  # signed DOCUMENT RESULT
  quietly openssl smime -sign -text -in "$1" -out "$2" -signer "$made/authority.pem" -inkey "$made/authority_key.pem"
}

cat >"$made/openssl.cnf" <<'END'
[req]
distinguished_name = subject
x509_extensions = authority
[subject]
[authority]
basicConstraints = critical, CA:TRUE, pathlen:0
keyUsage = critical, keyCertSign, digitalSignature
subjectKeyIdentifier = hash
END
new_key "$made/authority_key.pem"
quietly openssl req -x509 -config "$made/openssl.cnf" -sha256 -days "$days" -subj "/O=$lab/CN=authority" \
  -key "$made/authority_key.pem" -out "$made/authority.pem"

# One day longer on both sides, so that in every time zone the certificate is the limit.
mkdir "$made/unsigned"
"$permissions" "$made/unsigned" "$lab" "$(date -u -d '-1 day' +%Y-%m-%dT%H:%M:%S)" \
  "$(date -u -d "+$((days + 1)) days" +%Y-%m-%dT%H:%M:%S)" "$first" "$last" >"$made/identities"
signed "$made/unsigned/governance.xml" "$made/governance.p7s"
while read -r identity; do
  mkdir "$made/$identity"
  new_key "$made/$identity/key.pem"
  quietly openssl req -new -config "$made/openssl.cnf" -sha256 -subj "/O=$lab/CN=$identity" \
    -key "$made/$identity/key.pem" -out "$made/request.pem"
  quietly openssl x509 -req -sha256 -days "$days" -set_serial "0x$(openssl rand -hex 8)" \
    -CA "$made/authority.pem" -CAkey "$made/authority_key.pem" \
    -in "$made/request.pem" -out "$made/$identity/certificate.pem"
  signed "$made/unsigned/permissions_$identity.xml" "$made/$identity/permissions.p7s"
done <"$made/identities"

rm -r "$made/unsigned" "$made/identities" "$made/openssl.cnf" "$made/request.pem" "$log"
# Everybody may read every file but the keys.
find "$made" -type d -exec chmod 755 {} + -o ! -name '*key.pem' -exec chmod 644 {} +
mkdir -m 700 "$dir-authority"
mv "$made/authority_key.pem" "$dir-authority"
mv -T "$made" "$dir"
echo "$dir: valid for $days days; keep $dir-authority offline, away from the lab's machines, or delete it"
