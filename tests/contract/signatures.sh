#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A plugin signed by one of plugins.signers is loaded; an unsigned or modified one is rejected.
set -u
odograph=$1 plugins=$2
command -v openssl >/dev/null && openssl genpkey -algorithm ed25519 >/dev/null 2>&1 || { echo "SKIPPED: no openssl"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0
mkdir mine
cp "$plugins/attitude_vqf.so" "$plugins/attitude_vqf.odoplugin.json" mine/
openssl genpkey -algorithm ed25519 -out vendor.pem
openssl genpkey -algorithm ed25519 -out stranger.pem
key() { openssl pkey -in "$1" -pubout -outform DER | tail -c 32 | od -An -v -tx1 | tr -d ' \n'; }
sign() { openssl pkeyutl -sign -rawin -inkey "$1" -in mine/attitude_vqf.odoplugin.json -out mine/attitude_vqf.odoplugin.sig; }
config() { printf 'odograph: 1\nplugins: {search: [mine], signers: [%s]}\nattitude: {plugin: mine/attitude_vqf.odoplugin.json}\n' "$1" >config.yaml; }
by() { printf '{ids: "%s", key: %s}' "$1" "$(key "$2")"; }
# what, expected status, words
check() {
  "$odograph" config check config.yaml >said 2>&1
  status=$?
  [ $status -eq "$2" ] && grep -qF -- "$3" said || { echo "FAILED: $1: status $status"; cat said; failed=1; }
}
config "$(by '*' vendor.pem)"
check "no signature" 2 "attitude_vqf.odoplugin.sig is missing"
sign stranger.pem
check "a stranger's signature" 2 "is no signature of its manifest by any of plugins.signers"
sign vendor.pem
check "the vendor's signature" 0 ""
config "$(by 'attitude/*' stranger.pem), $(by '*' vendor.pem)"
check "one signer of two" 0 ""
# what, expected status, words, arguments of `plugin check`
signer() {
  what=$1 expected=$2 words=$3
  shift 3
  "$odograph" plugin check mine/attitude_vqf.so --only file.signature "$@" >said 2>&1
  status=$?
  [ $status -eq "$expected" ] && grep -qF -- "$words" said || { echo "FAILED: $what: status $status"; cat said; failed=1; }
}
signer "no --signer" 0 "1 do not apply"
signer "--signer of the vendor" 0 "1 passed" --signer "$(key vendor.pem)"
signer "--signer of a stranger" 4 "is no signature of its manifest" --signer "$(key stranger.pem)"
signer "--signer that is no key" 2 "64 hexadecimal digits" --signer "$(key vendor.pem)0"
printf ' ' >>mine/attitude_vqf.odoplugin.json
signer "--signer with a manifest that was changed" 4 "is no signature of its manifest" --signer "$(key vendor.pem)"
check "a manifest that was changed" 2 "is no signature of its manifest"
cp "$plugins/attitude_vqf.odoplugin.json" mine/
printf 'x' >>mine/attitude_vqf.so
check "a library that was changed" 2 "hash"
cp "$plugins/attitude_vqf.so" mine/
printf 'x' >>mine/attitude_vqf.odoplugin.sig
check "a signature that is too long" 2 "has another size"
config "$(by 'acme/*' vendor.pem)"
check "chosen by its path, with an id that nobody vouches for" 2 "is chosen by its path"
printf 'odograph: 1\nplugins: {signers: [%s]}\nattitude: {plugin: attitude/vqf}\n' "$(by 'acme/*' vendor.pem)" >config.yaml
check "an id of ours, with a signer for a vendor's alone" 0 ""
config '{key: abc}'
sign vendor.pem
check "a key that is none" 2 "expected a public key of 32 bytes"
exit $failed
