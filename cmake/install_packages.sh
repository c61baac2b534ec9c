#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# install_packages.sh SET...: installs the Debian packages of the named sets that are missing, and
# only those. Without any missing it neither needs the network nor root.
set -euo pipefail

declare -A packages=(
  # make demo, make test. spin checks the models, tshark and the python packages the dictionary,
  # valgrind counts instructions.
  [quick]="binutils cmake g++ ninja-build pkg-config libeigen3-dev libgtest-dev libcli11-dev
           libtomlplusplus-dev nlohmann-json3-dev libspng-dev libpng-dev libboost-dev
           libaravis-dev libusb-1.0-0-dev spin python3 python3-canmatrix python3-can tshark valgrind"
  # make check: the second compiler, format and lint
  [check]="clang-14 clang-format-14 clang-tidy-14"
  # make cross: aarch64 under an emulator, bare-metal Cortex-M7
  [cross]="g++-aarch64-linux-gnu qemu-user googletest gcc-arm-none-eabi libnewlib-arm-none-eabi
           libstdc++-arm-none-eabi-dev qemu-system-arm"
  # make bench: the peers
  [bench]="libpcl-dev libopencv-dev libnanoflann-dev libbenchmark-dev valgrind"
  # make coverage
  [coverage]="gcovr"
  # make test-vm: a guest with real kernel drivers
  [vm]="qemu-system-x86 busybox-static iproute2"
  # preset host-rtsan
  [rtsan]="clang-22 libclang-rt-22-dev"
)

missing=()
for set in "$@"; do
  [ -n "${packages[$set]:-}" ] || { echo "install_packages.sh: no set named '$set' (${!packages[*]})" >&2; exit 2; }
  for package in ${packages[$set]}; do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing+=("$package")
  done
done
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "Missing packages: ${missing[*]}. Install them as root, or install sudo." >&2; exit 1; }
  as_root=(sudo env DEBIAN_FRONTEND=noninteractive)  # sudo keeps no variables of its own accord.
fi
echo "Installing with apt: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
install=("${as_root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}")
# A list that is already there usually does; a stale or absent one is fetched once.
"${install[@]}" >/dev/null 2>&1 || { "${as_root[@]}" apt-get update -q; "${install[@]}"; }
