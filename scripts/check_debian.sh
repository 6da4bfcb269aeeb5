#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the two commands of the README in a bare Debian, from a fresh clone of the last commit:
#
#     sudo scripts/check_debian.sh 12|13|testing [FOLDER]
#
# Prints how long each step takes; what they say is in FOLDER/demo.log and FOLDER/test.log. Needs root,
# debootstrap and about 8 GB in FOLDER (default: a folder in /var/tmp). The folder stays: a second call goes
# on with its Debian and makes the clone anew. JOBS is the number of processes that build and test.
set -euo pipefail

here=$(dirname "$(realpath "$0")")
# shellcheck source=scripts/debian_chroot.sh
source "$here/debian_chroot.sh"
release=${1:?a release is needed: 12, 13 or testing}
folder=$(realpath -m "${2:-/var/tmp/statejump-debian-$release}")
root=$folder/root
jobs=${JOBS:-$(nproc)}
mkdir -p "$folder"

timed() { # name, command ...
  local name=$1 start=$SECONDS status=0
  shift
  "$@" || status=$?
  printf '%-34s %5d s%s\n' "$name" $((SECONDS - start)) "$([[ $status -eq 0 ]] || echo "  FAILED ($status)")"
  return $status
}

trap 'leave_debian "$root"' EXIT
timed "Debian $release" make_debian "$release" "$root"
timed "git and make" in_debian "$root" "apt-get update -qq && apt-get install -y -qq --no-install-recommends git make \
  ca-certificates >/dev/null 2>&1"
rm -rf "$root/root/statejump"
timed "clone" git clone -q --no-local "$here/.." "$root/root/statejump"
failed=0
timed "make demo" in_debian "$root" "cd /root/statejump && make demo JOBS=$jobs" >"$folder/demo.log.part" 2>&1 || failed=1
mv "$folder/demo.log.part" "$folder/demo.log"
tail -1 "$folder/demo.log"
timed "make test" in_debian "$root" "cd /root/statejump && make test JOBS=$jobs" >"$folder/test.log.part" 2>&1 || failed=1
mv "$folder/test.log.part" "$folder/test.log"
tail -1 "$folder/test.log"
grep -E '^[0-9]+% tests passed|\*\*\*|^	' "$folder/test.log" || true
exit $failed
