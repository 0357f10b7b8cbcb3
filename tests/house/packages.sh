#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The build as Debian packages: lintian finds no error, the tarball runs from another folder, its plugins are signed,
# and the SBOM lists every library found by ldd and the linker's maps. packaging/try_packages continues on a bare
# Debian.
set -eu
source=$1 build=$2
for program in dh lintian git dpkg-buildpackage openssl; do
  command -v $program > /dev/null || { echo "SKIPPED: no $program"; exit 77; }
done
git -C "$source" rev-parse HEAD > /dev/null 2>&1 || { echo "SKIPPED: no git repository"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The same version everywhere.
version=$(sed -n 's/^project(Odograph VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
for place in packaging/debian/changelog:"odograph ($version)" \
  abi/bindings/csharp/package.json:"\"$version\"" abi/bindings/javascript/package.json:"\"$version\"" abi/bindings/python/pyproject.toml:"version = \"$version\"" abi/bindings/rust/Cargo.toml:"version = \"$version\""; do
  grep -qF "${place#*:}" "$source/${place%%:*}" || { echo "${place%%:*}: its version is not $version"; exit 1; }
done

# A repository is signed by a key that somebody named.
env -u GNUPGHOME "$source/packaging/repository" "$work/repository" none.deb 2> "$work/said" && { echo "a repository without a key"; exit 1; }
grep -q 'GNUPGHOME' "$work/said"

openssl genpkey -algorithm ed25519 -out "$work/key.pem"
ODOGRAPH_KEY="$work/key.pem" "$source/packaging/packages" --build "$build" --out "$work/packages"
mkdir "$work/some folder"
tar -C "$work/some folder" -xf "$work"/packages/*.tar.gz
root=$(echo "$work/some folder"/*)
cd "$work"
env -u ODOGRAPH_PLUGIN_PATH "$root/bin/odograph" plugins | grep '^vo/odograph'
"$root/bin/odograph" sim "$root/share/odograph/samples/scenarios/walk_short.yaml" --first 8 -o walk.odo > /dev/null
env -u ODOGRAPH_PLUGIN_PATH "$root/bin/odograph" run -c "$root/share/odograph/samples/configs/phone_walk.yaml" -i walk.odo -o run --json > /dev/null
"$build/bin/odograph" run -c "$source/samples/configs/phone_walk.yaml" -i walk.odo -o from_build --json > /dev/null
cmp run/trajectory.tum from_build/trajectory.tum

# What packages need and hold of others.
plugin=$(echo packages/odograph-plugin-vo-odograph_*.deb)
dpkg-deb -f "$plugin" Depends | grep -q 'odograph-plugin-abi-1'
dpkg-deb -f packages/libodograph1_*.deb Provides | grep -q 'odograph-plugin-abi-1 (= 1\.[0-9]'
dpkg-deb --fsys-tarfile packages/libodograph1_*.deb | tar -t | grep -q '/odograph/odograph-plugin-host$' # of the library's own version
dpkg-deb -I packages/libodograph1_*.deb symbols | grep -q ' odo_abi_version@ODOGRAPH_1.0 '
dpkg-deb -f "$plugin" Static-Built-Using | grep -q 'ceres-solver (= .*eigen3 (= '
if dpkg-deb -f "$plugin" Depends | grep -q atlas; then echo "vo/odograph needs ATLAS"; exit 1; fi

# Packages of two architectures can be installed together: what both have is the same, the rest has the architecture in its path.
architecture=$(dpkg --print-architecture)
for package in packages/*_"$architecture".deb; do
  case $package in packages/odograph_*) continue ;; esac # the command line, of one architecture
  dpkg-deb --fsys-tarfile "$package" | tar -t > files
  if grep -v -E "/\$|^\./usr/(lib|include)/|/(copyright|changelog\.gz|NOTICE)\$|/doc/[^/]*/[a-z]*\.$architecture\." files; then echo "$package: not for a second architecture"; exit 1; fi
done

key=$(openssl pkey -in key.pem -pubout -outform DER | tail -c 32 | od -An -v -tx1 | tr -d ' \n')
printf 'odograph: 1\nplugins: {signers: [{key: %s}]}\nattitude: {plugin: attitude/vqf}\n' "$key" > signed.yaml
"$root/bin/odograph" config check signed.yaml
rm "$root"/lib*/odograph/plugins/attitude_vqf.odoplugin.sig
"$root/bin/odograph" config check signed.yaml > said 2>&1 && { echo "an unsigned plugin passed"; exit 1; }
grep -q "attitude_vqf.odoplugin.sig is missing" said

python3 "$source/tests/house/sbom.py" "$root" "$build"
