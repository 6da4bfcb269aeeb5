# shellcheck shell=bash
# SPDX-License-Identifier: GPL-3.0-or-later
# For check_debian.sh and check_package.sh: a bare Debian in a folder.
#
#     make_debian 12|13|testing FOLDER    makes it with debootstrap, unless it is there already
#     in_debian FOLDER COMMAND            runs a command of bash in it, as root with a bare environment
#     leave_debian FOLDER                 ends what make_debian mounted
#
# Certificates of this machine's own (/usr/local/share/ca-certificates) hold in it too: behind a proxy that opens
# TLS, npm reaches no registry without them. The mirror is MIRROR, else that of the apt of this machine. With CCACHE_DIR
# set, that cache serves the compilers inside, too.

make_debian() {
  local release=$1 root=$2 codename said mirror=${MIRROR:-}
  case $release in
    12) codename=bookworm ;;
    13) codename=trixie ;;
    testing) codename=testing ;;
    *) echo "release $release: 12, 13 or testing is needed" >&2; return 2 ;;
  esac
  [[ $(id -u) -eq 0 ]] || { echo "needs root" >&2; return 1; }
  command -v debootstrap >/dev/null || { echo "debootstrap is missing: apt-get install debootstrap" >&2; return 1; }
  [[ -n $mirror ]] || mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' | head -1)
  if [[ ! -e $root/etc/debian_version ]]; then
    # The script of unstable serves every newer release that this debootstrap does not know by name.
    if ! said=$(debootstrap --variant=minbase "$codename" "$root" "${mirror:-http://deb.debian.org/debian}" \
      /usr/share/debootstrap/scripts/sid 2>&1); then
      leave_debian "$root"
      rm -rf --one-file-system "$root"
      echo "debootstrap: $(echo "$said" | tail -n 1)" >&2
      return 1
    fi
  fi
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  if compgen -G "/usr/local/share/ca-certificates/*.crt" >/dev/null; then
    mkdir -p "$root/usr/local/share/ca-certificates"
    cp /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates/"
  fi
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
  mkdir -p "$root/dev/shm"
  mountpoint -q "$root/dev/shm" || mount -t tmpfs tmpfs "$root/dev/shm"
  mkdir -p "$root/dev/pts"
  mountpoint -q "$root/dev/pts" || mount -t devpts devpts "$root/dev/pts"
  if [[ -n ${CCACHE_DIR:-} ]]; then
    mkdir -p "$root/var/cache/ccache"
    mountpoint -q "$root/var/cache/ccache" || mount --bind "$CCACHE_DIR" "$root/var/cache/ccache"
  fi
}

in_debian() {
  local cache=()
  if mountpoint -q "$1/var/cache/ccache"; then
    cache=(CCACHE_DIR=/var/cache/ccache CCACHE_BASEDIR=/root/statejump CCACHE_NOHASHDIR=1
           CMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  chroot "$1" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    NODE_EXTRA_CA_CERTS=/etc/ssl/certs/ca-certificates.crt "${cache[@]}" \
    bash -euo pipefail -c "$2"
}

leave_debian() {
  umount "$1/var/cache/ccache" 2>/dev/null || true
  umount "$1/dev/pts" "$1/dev/shm" "$1/proc" 2>/dev/null || true
}
