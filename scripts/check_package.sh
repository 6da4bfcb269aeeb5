#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs a Debian package of statejump in a fresh minimal Debian and runs it there, far from any
# source or build tree:
#
#     make package && sudo scripts/check_package.sh build/package/statejump_*.deb [12|13|testing [FOLDER]]
#
# The release is that of this machine if none is given. Needs root, debootstrap and about 4 GB in FOLDER
# (default: a temporary folder, removed at the end). MIRROR is the Debian mirror, that of this machine's apt
# by default.
set -euo pipefail

# shellcheck source=scripts/debian_chroot.sh
source "$(dirname "$(realpath "$0")")/debian_chroot.sh"
package=$(realpath "${1:?a .deb file is needed}")
release=${2:-$(. /etc/os-release && echo "${VERSION_ID:-testing}")}
kept=${3:-}
root=${kept:-$(mktemp -d)}

clean_up() {
  leave_debian "$root"
  [[ -n $kept ]] || rm -rf --one-file-system "$root"
}
trap clean_up EXIT

make_debian "$release" "$root"
mkdir -p "$root/var/tmp/package"
cp "$package" "$root/var/tmp/package/"

in_debian "$root" "$(cat <<'INSIDE'
apt-get update -qq
apt-get install -y -qq --no-install-recommends "/var/tmp/package/$(ls -t /var/tmp/package | head -1)" >/var/tmp/apt.log 2>&1 ||
  { tail -20 /var/tmp/apt.log; exit 1; }
folder=$(mktemp -d) && cd "$folder"
echo "== command, both models"
statejump compare cases/table1.toml
echo "== page of that run"
statejump report results/table1
test -s results/table1/report.html
echo "== a truss, its schema, the Python package"
statejump truss ring 6 -o ring.toml
head -1 ring.toml
test -s "$(head -1 ring.toml | sed 's,#:schema file://,,')"
cd / && /usr/bin/python3 -c "import statejump; print('statejump', statejump.__version__, statejump.__file__)"
echo "== plugin in plain yade"
cd "$folder"
printf 'import statejump_yade\nprint("plugin", statejump_yade.__file__, statejump_yade.Bearing(radius=1).radius)\n' >plugin.py
yade -n -x plugin.py </dev/null | grep ^plugin
echo "== removal"
apt-get remove -y -qq statejump >/dev/null 2>&1
left=$(find / -xdev -path /proc -prune -o -path "$folder" -prune -o -path '*statejump*' -print | grep -v -e ^/var/ -e ^/tmp/ || true)
[[ -z $left ]] || { echo "left behind: $left"; exit 1; }
INSIDE
)"
echo "package works: $(basename "$package")"
