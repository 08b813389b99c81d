#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Commands in a fresh Debian, as whoever has just cloned the project types them.
#   debian.sh SUITE DIR COMMAND...    SUITE: bookworm or trixie; DIR gets the system and keeps it
# As root, since it installs a system; skipped with a line, and exit status 77, where it cannot. The
# tree is what is committed. Pictures are read from the folder that CALVIN_DATA names.
set -eu

[ $# -ge 3 ] || { sed -n '4s/^# *//p' "$0" >&2; exit 2; }
suite=$1
case "$suite" in
  bookworm | trixie) ;;
  *) echo "$0: there is no suite '$suite' (bookworm, trixie)" >&2; exit 2 ;;
esac
skip() { echo "Debian $suite: $1: skipped."; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "only root can install a system"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
# In mounts of our own, which end with us however that is.
[ -n "${CALVIN_OWN_MOUNTS:-}" ] || {
  unshare --mount true 2>/dev/null || skip "nothing can be mounted here"
  CALVIN_OWN_MOUNTS=1 exec unshare --mount "$0" "$@"
}

source=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$2"
root=$(cd "$2" && pwd)
shift 2

# Where this machine itself gets Debian from.
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' |
  head -n 1)
[ -n "$mirror" ] || skip "apt names no mirror of Debian"
[ -e "$root/etc/calvin-$suite" ] || {
  debootstrap --variant=minbase "$suite" "$root" "$mirror"
  touch "$root/etc/calvin-$suite"
}

# The network as it is outside.
cp /etc/resolv.conf "$root/etc/resolv.conf"
apt-config dump --format '%F "%v";%n' | grep '^Acquire::.*[Pp]roxy' \
  >"$root/etc/apt/apt.conf.d/99proxy" || true

rm -rf "$root/gst-calvin"
git -c safe.directory='*' clone -q --no-hardlinks "$source" "$root/gst-calvin"
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"
data=""
if [ -n "${CALVIN_DATA:-}" ]; then
  data=/calvin-data
  mkdir -p "$root$data"
  mount --bind "$CALVIN_DATA" "$root$data"
  mount -o remount,bind,ro "$root$data"
fi

# Nothing of this machine's environment but the way to the network.
run() {
  echo "Debian $suite: $1"
  chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
    CALVIN_DATA="$data" CALVIN_WERROR="${CALVIN_WERROR:-false}" \
    ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
    sh -c "cd /gst-calvin && exec $1" || { echo "Debian $suite: $1 has failed"; exit 1; }
}
for command in "$@"; do
  run "$command"
done
