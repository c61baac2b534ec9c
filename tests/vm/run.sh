#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tests/vm/run.sh BUILD [KERNEL-PACKAGE...]: the tests that need kernel drivers, in a virtual machine.
#
# Boots Debian's own kernels, PREEMPT_RT first, under QEMU's own emulation (no KVM is needed) with
# virtual cameras (vivid) and CAN interfaces (vcan, vxcan, an emulated Kvaser pair). The host's root
# is the guest's, read-only, so that nothing is installed in it. Results lie in BUILD/vm/out-KERNEL.
# The first kernel then boots twice more with time counted in instructions: latencies, which must be
# the same in both, and the main job. Results lie in BUILD/vm/out-counted-1 and -2.
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

kernel_of() { apt-cache depends "$1" 2>/dev/null | awk '/Depends: linux-image/ {print $2; exit}'; }

# The package name that a meta package stands for changes with every security update.
prepare() {
  local package real folder=$build/vm/$1
  package=$1
  real=$(kernel_of "$package")
  if [ -z "$real" ]; then
    apt-get -q update || true
    real=$(kernel_of "$package")
  fi
  [ -n "$real" ] || { echo "test-vm needs the package $package, and apt does not know it"; exit 2; }
  mkdir -p "$folder"
  [ "$(cat "$folder/made-of" 2>/dev/null)" = "$real $(cat "$here/guest/init" "$here/make_guest.py" | cksum)" ] && return
  rm -f "$folder"/*.deb
  (cd "$folder" && apt-get -q download "$real")
  python3 "$here/make_guest.py" "$folder"/*.deb "$(command -v busybox)" "$folder" "${modules[@]}"
  rm -f "$folder"/*.deb
  echo "$real $(cat "$here/guest/init" "$here/make_guest.py" | cksum)" >"$folder/made-of"
}

# boot KERNEL OUT SCRIPT QEMU-OPTION...: the script's exit code in the guest, 125 when it never got there.
boot() {
  local guest=$build/vm/$1 out=$2 script=$3 append=${append:-}
  shift 3
  echo "$build" >"$out/build"
  [ -z "${DSEAM_VCAN_POINTS:-}" ] ||
    echo "export DSEAM_VCAN_POINTS=$DSEAM_VCAN_POINTS PROGRAM_TIMEOUT=3000" >"$out/environment"
  timeout "${VM_TIMEOUT:-560}" qemu-system-x86_64 -M pc -cpu max "$@" \
    -m 1024 -nodefaults -no-user-config -display none -serial stdio -no-reboot \
    -object can-bus,id=bus0 -device kvaser_pci,canbus=bus0 -device kvaser_pci,canbus=bus0 \
    -fsdev local,id=hostroot,path=/,security_model=none,multidevs=remap,readonly=on \
    -device virtio-9p-pci,fsdev=hostroot,mount_tag=hostroot \
    -fsdev "local,id=out,path=$out,security_model=none,multidevs=remap" \
    -device virtio-9p-pci,fsdev=out,mount_tag=out \
    -kernel "$guest/kernel" -initrd "$guest/initrd" \
    -append "console=ttyS0 panic=-1 quiet $append vm.run=$here/guest/$script" </dev/null || true
  [ -s "$out/rc" ] && return "$(cat "$out/rc")"
  return 125
}

empty_folder() { rm -rf "$1" && mkdir -p "$1"; }

# run NAME COMMAND...: counts its time and keeps its failure.
result=0
run() {
  local name=$1 started=$SECONDS rc=0
  shift
  "$@" || rc=$?
  [ $rc = 0 ] || result=$rc
  echo "test-vm: $name took $((SECONDS - started)) s, result $rc"
}

drivers() {
  empty_folder "$build/vm/out-$1"
  boot "$1" "$build/vm/out-$1" guest.sh -accel tcg,thread=multi -smp 2
}

# Two nanoseconds an instruction on one processor, the same addresses in each run: idle time is
# skipped, the host's load is not seen.
counted() {
  local out=$build/vm/out-counted-$2
  empty_folder "$out"
  [ "$2" = 2 ] || touch "$out/main-job"
  append="nokaslr norandmaps" boot "$1" "$out" counted.sh -icount shift=1,sleep=off \
    -accel tcg,thread=single -smp 1 -rtc base=2026-01-01,clock=vm
}

# To 2 us of the wake-up and 100 us of the rest: when the host's files answer still
# moves an interrupt now and then.
same_latencies() {
  paste "$build/vm/out-counted-1/latencies" "$build/vm/out-counted-2/latencies" |
    awk '{ limit = $2 == "wake-up" ? 2000 : 100000; d = $6 - $12; d = d < 0 ? -d : d
           if (d > limit) { print "differs by", d, "ns:", $0; bad = 1 } }
         END { exit NR == 3 ? bad : 1 }'
}

for kernel in "${kernels[@]}"; do
  prepare "$kernel"
  run "$kernel" drivers "$kernel"
done
if [ -x "$build/examples/dseam/dseam" ]; then
  rm -rf "$build/vm/scan-set"
  "$build/examples/dseam/dseam" record --camera sim --set cell.width=1280 --set cell.height=720 \
    --out "$build/vm/scan-set" >/dev/null
  run "${kernels[0]}, counted" counted "${kernels[0]}" 1
  run "${kernels[0]}, counted again" counted "${kernels[0]}" 2
  run "same latencies in both" same_latencies
fi
exit $result
