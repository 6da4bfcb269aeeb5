#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs, with apt, the Debian packages of the groups that are named; without a name, of all groups:
#
#     scripts/setup.sh run build
#
#     run     what the command needs, and so what the Debian package depends on
#     build   compiling                             test    tests and checks
#     page    bundling the page of the report       bench   benchmarks
#     package making the Debian package             docs    documentation
#
# A group is a file in scripts/packages. Does nothing when everything is there. Root and sudo alike. A package with a
# question mark behind its name is one that not every Debian has: it is installed where it can be had.
set -euo pipefail

lists=$(dirname "${BASH_SOURCE[0]}")/packages
groups=("$@")
if [[ $# -eq 0 ]]; then
  for list in "$lists"/*.txt; do groups+=("$(basename "$list" .txt)"); done
fi
missing=()
optional=()
for group in "${groups[@]}"; do
  [[ -f $lists/$group.txt ]] || { echo "set-up: no group $group in $lists" >&2; exit 2; }
  while read -r package; do
    case $package in # any Node of version 18 or later that is there will do
      nodejs) ! command -v node >/dev/null || continue ;;
      npm) ! command -v npm >/dev/null || continue ;;
    esac
    status=$(dpkg-query --show --showformat='${db:Status-Abbrev}' "${package%\?}" 2>/dev/null || true)
    case $status,$package in
      ii*) ;;
      *\?) optional+=("${package%\?}") ;;
      *) missing+=("$package") ;;
    esac
  done <"$lists/$group.txt"
done
can_be_had() { # those of the optional packages that the lists of apt have
  local package version
  for package in "${optional[@]}"; do
    version=$(LC_ALL=C apt-cache policy "$package" 2>/dev/null | sed -n 's/^ *Candidate: *//p')
    [[ -z $version || $version == "(none)" ]] || echo "$package"
  done
}
[[ ${#missing[@]} -ne 0 || -n $(can_be_had) ]] || exit 0

if ! command -v apt-get >/dev/null; then
  echo "set-up: apt-get not found; install by hand: ${missing[*]}" >&2
  exit 2
fi
as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null || {
    echo "set-up: run as root or install sudo; missing packages: ${missing[*]}" >&2
    exit 2
  }
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update -qq
mapfile -t -O "${#missing[@]}" missing < <(can_be_had)
echo "set-up: installing ${missing[*]}"
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
