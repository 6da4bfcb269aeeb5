#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the two commands of the README in a bare Debian, from a fresh clone of the last commit:
#
#     sudo scripts/check_debian.sh [--quick] 12|13|testing [FOLDER]
#
# Prints how long each step takes; what they say is in FOLDER/demo.log and FOLDER/test.log. Needs root,
# debootstrap and about 8 GB in FOLDER (default: a folder in /var/tmp). The folder stays: a second call goes
# on with its Debian and makes the clone anew. JOBS is the number of processes that build and test. With CCACHE_DIR set,
# compilers take from that cache what they can: the times are then not those of a bare machine.
#
# --quick: `make quick` instead, on standard output. Exit status 75 with a last line that says why if that Debian
# cannot be had here (no root, no debootstrap, no network).
set -euo pipefail

here=$(dirname "$(realpath "$0")")
# shellcheck source=scripts/debian_chroot.sh
source "$here/debian_chroot.sh"
quick=
if [[ ${1:-} == --quick ]]; then
  quick=yes
  shift
fi
release=${1:?a release is needed: 12, 13 or testing}
folder=$(realpath -m "${2:-/var/tmp/statejump-debian-$release}")
root=$folder/root
jobs=${JOBS:-$(nproc)}

timed() { # name, command ...
  local name=$1 start=$SECONDS status=0
  shift
  "$@" || status=$?
  printf '%-34s %5d s%s\n' "$name" $((SECONDS - start)) "$([[ $status -eq 0 ]] || echo "  FAILED ($status)")"
  return $status
}

# As above, but a failure means that this Debian cannot be had; 2: asked for what there is not.
needed() {
  local name=$1 said status=0
  shift
  said=$(timed "$name" "$@" 2>&1) || status=$?
  echo "$said"
  ((status != 0)) || return 0
  [[ -n $quick && $status -ne 2 ]] || exit "$status"
  echo "Debian $release cannot be had here: $(echo "$said" | grep -v -e '^$' -e '  FAILED (' | tail -n 1)"
  exit 75
}

[[ -n $quick ]] || mkdir -p "$folder"
trap 'leave_debian "$root"' EXIT
needed "Debian $release" make_debian "$release" "$root"
needed "git and make" in_debian "$root" "apt-get update -qq -o APT::Update::Error-Mode=any && apt-get install -y -qq \
  --no-install-recommends git make ca-certificates ${CCACHE_DIR:+ccache} >/dev/null"
rm -rf "$root/root/statejump"
timed "clone" git clone -q --no-local "$here/.." "$root/root/statejump"
if [[ -n $quick ]]; then
  # Packages that this Debian does not have are a failure, those that do not arrive are none.
  packages="/root/statejump/scripts/packages/{run,build,test}.txt"
  timed "names of packages" in_debian "$root" "grep -hv '?$' $packages | xargs apt-get install -s -qq >/dev/null"
  needed "packages" in_debian "$root" "cd /root/statejump && scripts/setup.sh run build test"
  timed "make quick" in_debian "$root" "cd /root/statejump && make quick JOBS=$jobs"
  exit
fi
failed=0
timed "make demo" in_debian "$root" "cd /root/statejump && make demo JOBS=$jobs" >"$folder/demo.log.part" 2>&1 || failed=1
mv "$folder/demo.log.part" "$folder/demo.log"
tail -1 "$folder/demo.log"
timed "make test" in_debian "$root" "cd /root/statejump && make test JOBS=$jobs" >"$folder/test.log.part" 2>&1 || failed=1
mv "$folder/test.log.part" "$folder/test.log"
tail -1 "$folder/test.log"
grep -E '^[0-9]+% tests passed|\*\*\*|^	' "$folder/test.log" || true
exit $failed
