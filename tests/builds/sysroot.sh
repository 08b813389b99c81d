#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Unpacks Debian packages of another architecture into a folder, to compile and run against. Packages
# come from where apt takes those of this system; nothing is installed, and it needs no root.
#   sysroot.sh ARCHITECTURE DIR PACKAGE...
set -eu

[ $# -ge 3 ] || { sed -n '3,5s/^# *//p' "$0" >&2; exit 2; }
architecture=$1
root=$2
shift 2
if [ -e "$root/complete" ] && [ "$(cat "$root/complete")" = "$*" ]; then exit 0; fi
rm -rf "$root"
mkdir -p "$root/apt/lists/partial" "$root/apt/archives/partial"
: >"$root/apt/status" # in which nothing is installed

foreign_apt() {
  apt-get -q -o APT::Architecture="$architecture" -o APT::Architectures::="$architecture" \
    -o Dir::State="$root/apt" -o Dir::State::status="$root/apt/status" \
    -o Dir::Cache="$root/apt" -o Debug::NoLocking=1 "$@"
}
foreign_apt update
foreign_apt install -y --download-only --no-install-recommends "$@"

# Packages still name /lib, which is a link to /usr/lib.
mkdir -p "$root/usr/lib" "$root/usr/bin" "$root/usr/sbin"
for folder in lib bin sbin; do ln -s "usr/$folder" "$root/$folder"; done
for package in "$root"/apt/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar -C "$root" -xf - --keep-directory-symlink
done
rm -r "$root/apt"

# Links name files of the system that this folder is not.
find "$root" -type l -lname '/*' | while read -r link; do
  ln -sfnr "$root$(readlink "$link")" "$link"
done
# What a package leaves to update-alternatives.
for library in blas lapack; do
  for file in "$root"/usr/lib/*/$library/lib$library.so.3; do
    [ ! -e "$file" ] || ln -sfr "$file" "$(dirname "$file")/../lib$library.so.3"
  done
done
echo "$*" >"$root/complete"
