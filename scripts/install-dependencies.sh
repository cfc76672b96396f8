#!/bin/bash
# Installs what building Etendue needs, on Debian and Ubuntu. Only what is missing: where nothing is, nothing is touched.
# usage: install-dependencies.sh [--fuzz] [--lint] [--peers]
#   --fuzz: for `make fuzz` too; --lint: for `make format` and `make tidy` too; --peers: for `make bench-peers` too
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache pkg-config python3
  libembree-dev libtbb-dev
  libopenimageio-dev openimageio-tools # OpenImageIO's CMake files insist on its command line tools
  fonts-dejavu-core # for the labels of `make figures`
  libopenexr-dev libimath-dev libnanovdb-dev
  libopenvdb-dev libboost-dev libblosc-dev # OpenVDB's headers include Boost's
  python3-numpy python3-openimageio # for `make conformance`
  libpugixml-dev zlib1g-dev libcli11-dev libfmt-dev libspdlog-dev nlohmann-json3-dev
  libgtest-dev libgmock-dev libbenchmark-dev
)

for option in "$@"; do
  case "$option" in
    --fuzz) packages+=(clang libclang-rt-dev) ;;
    --lint) packages+=(clang-format clang-tidy) ;;
    --peers) packages+=(blender) ;;
    *) echo "install-dependencies.sh: unknown option $option; there are --fuzz, --lint and --peers." >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  cat >&2 <<'TEXT'
This script knows Debian and Ubuntu only. Elsewhere, please install: a C++20 compiler (GCC 12 or later), CMake 3.22,
Ninja, Python 3, Embree 3, oneTBB, OpenImageIO 2.4, OpenEXR 3, Imath 3,
OpenVDB 10 with NanoVDB, Blosc, Boost's headers, pugixml, zlib, CLI11 2, fmt 9, spdlog, nlohmann-json,
GoogleTest with GoogleMock, Google Benchmark, the DejaVu fonts, NumPy and OpenImageIO's module for /usr/bin/python3; Clang
with its sanitizer runtime for the fuzzers.
Then: cmake --preset release.
TEXT
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat '${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "To install ${missing[*]} this needs root: please run it as root, or install sudo." >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends -o Dpkg::Use-Pty=0 "${missing[@]}" >/dev/null
