#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tests/vm/run.sh BUILD [KERNEL-PACKAGE...]: the tests that need kernel drivers, in a virtual machine.
#
# Boots Debian's own kernels, PREEMPT_RT first, under QEMU's own emulation (no KVM is needed) with
# virtual cameras (vivid) and CAN interfaces (vcan, vxcan, an emulated Kvaser pair). The host's root
# is the guest's, read-only, so that nothing is installed in it. Results lie in BUILD/vm/out-KERNEL.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${1:?the build folder}" && pwd)
shift
kernels=("$@")
[ ${#kernels[@]} -gt 0 ] || kernels=(linux-image-rt-amd64 linux-image-amd64)
modules=(virtio_pci 9pnet_virtio 9p overlay can-raw can-bcm can-gw vcan vxcan kvaser_pci vivid)

need() { command -v "$1" >/dev/null || { echo "test-vm needs $1: apt-get install $2"; exit 2; }; }
need qemu-system-x86_64 qemu-system-x86
need busybox busybox-static
need ip iproute2

# The package name that a meta package stands for changes with every security update.
prepare() {
  local package real folder=$build/vm/$1
  package=$1
  real=$(apt-cache depends "$package" | awk '/Depends: linux-image/ {print $2; exit}')
  [ -n "$real" ] || { echo "no package $package; try apt-get update"; exit 2; }
  mkdir -p "$folder"
  [ "$(cat "$folder/made-of" 2>/dev/null)" = "$real $(cat "$here/init" "$here/make_guest.py" | cksum)" ] && return
  rm -f "$folder"/*.deb
  (cd "$folder" && apt-get -q download "$real")
  python3 "$here/make_guest.py" "$folder"/*.deb "$(command -v busybox)" "$folder" "${modules[@]}"
  rm -f "$folder"/*.deb
  echo "$real $(cat "$here/init" "$here/make_guest.py" | cksum)" >"$folder/made-of"
}

# The guest's exit code, 124 when time ran out, 125 when it never got to the tests.
boot() {
  local guest=$build/vm/$1 out=$build/vm/out-$1
  rm -rf "$out"
  mkdir -p "$out"
  echo "$build" >"$out/build"
  timeout "${VM_TIMEOUT:-560}" qemu-system-x86_64 -M pc -cpu max -accel tcg,thread=multi -smp 2 \
    -m 1024 -nodefaults -no-user-config -display none -serial stdio -no-reboot \
    -object can-bus,id=bus0 -device kvaser_pci,canbus=bus0 -device kvaser_pci,canbus=bus0 \
    -fsdev local,id=hostroot,path=/,security_model=none,multidevs=remap,readonly=on \
    -device virtio-9p-pci,fsdev=hostroot,mount_tag=hostroot \
    -fsdev "local,id=out,path=$out,security_model=none,multidevs=remap" \
    -device virtio-9p-pci,fsdev=out,mount_tag=out \
    -kernel "$guest/kernel" -initrd "$guest/initrd" \
    -append "console=ttyS0 panic=-1 quiet vm.run=$here/guest.sh" </dev/null || true
  [ -s "$out/rc" ] && return "$(cat "$out/rc")"
  return 125
}

result=0
for kernel in "${kernels[@]}"; do
  prepare "$kernel"
  started=$SECONDS
  boot "$kernel" || result=$?
  echo "test-vm: $kernel took $((SECONDS - started)) s, result $result"
done
exit $result
