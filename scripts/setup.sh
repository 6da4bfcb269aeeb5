#!/usr/bin/env bash
# Installs, with apt, the Debian packages that the build, the tests and the demo need.
# Does nothing when all of them are there. Root and sudo alike.
set -euo pipefail

# What running needs, and so what the Debian package depends on.
mapfile -t packages <"$(dirname "${BASH_SOURCE[0]}")/runtime_packages.txt"
packages+=(
  build-essential cmake ninja-build clang-format git
  libboost-dev libboost-python-dev libboost-serialization-dev libboost-math-dev libboost-system-dev
  libcgal-dev libgmp-dev libmpfr-dev
  libeigen3-dev libsuitesparse-dev libgl-dev pybind11-dev python3-dev
  python3-pytest python3-jsonschema
  doxygen python3-sphinx python3-breathe furo
  libgtest-dev libbenchmark-dev xvfb xauth chromium
)
# Any Node of version 18 or later that is there will do for the page of the report.
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Abbrev}' "$package" 2>/dev/null || true)
  [[ $status == ii* ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

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
echo "set-up: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
