#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""make_guest.py KERNEL.deb BUSYBOX OUT MODULE...: OUT/kernel and OUT/initrd of a guest.

Reads a Debian kernel package without installing it. The kernel is unpacked (an emulator would take
longer for that), the initrd holds busybox, `guest/init`, and the named modules with all
that they depend on, in loading order."""
import io
import gzip
import lzma
import re
import struct
import subprocess
import sys
import tarfile
from pathlib import Path

KEPT = re.compile(r"kernel/(net/(can|9p)|drivers/(net/can|media|virtio|char|base)|"
                  r"fs/(9p|netfs|fscache|overlayfs)|lib|crypto)/")


def module_name(path):
    return Path(path).stem.replace("-", "_")


def read_package(deb):
    """The kernel image, its modules and the names of those that are built in."""
    image, modules, builtin = None, {}, set()
    unpack = subprocess.Popen(["dpkg-deb", "--fsys-tarfile", deb], stdout=subprocess.PIPE)
    with tarfile.open(fileobj=unpack.stdout, mode="r|") as package:
        for entry in package:
            if "/boot/vmlinuz-" in entry.name:
                image = package.extractfile(entry).read()
            elif entry.name.endswith(".ko") and KEPT.search(entry.name):
                modules[module_name(entry.name)] = package.extractfile(entry).read()
            elif entry.name.endswith("/modules.builtin"):
                lines = package.extractfile(entry).read().decode().split()
                builtin = {module_name(line) for line in lines}
    unpack.wait()
    return image, modules, builtin


def loading_order(wanted, modules, builtin):
    order = []

    def add(name):
        name = name.replace("-", "_")
        if name in order or name in builtin:
            return
        if name not in modules:
            sys.exit(f"the kernel has no module {name}")
        depends = re.search(rb"\0depends=([^\0]*)\0", modules[name]).group(1).decode()
        for other in filter(None, depends.split(",")):
            add(other)
        order.append(name)

    for name in wanted:
        add(name)
    return order


def unpacked(image):
    """The ELF kernel inside a bzImage (x86 boot protocol 2.08: payload_offset and _length)."""
    offset, length = struct.unpack_from("<II", image, 0x248)
    start = ((image[0x1F1] or 4) + 1) * 512 + offset
    payload = image[start:start + length]
    if payload[:6] == b"\xfd7zXZ\0":
        return lzma.LZMADecompressor().decompress(payload)
    return gzip.decompress(payload)


class Cpio:
    """An archive in the format that the kernel unpacks (newc)."""

    def __init__(self):
        self.out, self.inode = io.BytesIO(), 0

    def put(self, name, mode, data=b"", device=(0, 0)):
        self.inode += 1
        name = name.encode() + b"\0"
        fields = (self.inode, mode, 0, 0, 1, 0, len(data), 0, 0, *device, len(name), 0)
        for part in ("070701".encode() + b"".join(b"%08X" % f for f in fields) + name, data):
            self.out.write(part)
            self.out.write(b"\0" * (-self.out.tell() % 4))


def main():
    deb, busybox, out, wanted = sys.argv[1], sys.argv[2], Path(sys.argv[3]), sys.argv[4:]
    image, modules, builtin = read_package(deb)
    order = loading_order(wanted, modules, builtin)
    archive = Cpio()
    for folder in ("bin", "m", "proc", "sys", "dev", "lower", "ov", "root", "host"):
        archive.put(folder, 0o40755)
    archive.put("dev/console", 0o20600, device=(5, 1))
    archive.put("bin/busybox", 0o100755, Path(busybox).read_bytes())
    archive.put("init", 0o100755, (Path(__file__).parent / "guest" / "init").read_bytes())
    for name in order:
        archive.put(f"m/{name}.ko", 0o100644, modules[name])
    archive.put("m/order", 0o100644, "".join(name + "\n" for name in order).encode())
    archive.put("TRAILER!!!", 0)
    out.mkdir(parents=True, exist_ok=True)
    (out / "kernel").write_bytes(unpacked(image))
    (out / "initrd").write_bytes(archive.out.getvalue())


main()
