#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_growth.py CORE_GROWTH [instructions]: how the instructions (by callgrind) and the time of each
stage of the core grow from 100,000 to 3,000,000 points of constant density in the order of a scan, as
the slope of their logarithms; fails where one is over what is asked. With `instructions` no times:
those are for a quiet machine."""
import math
import re
import subprocess
import sys
import tempfile

FEW, MANY = 100_000, 3_000_000
MOST = {"instructions": 1.02, "ms": 1.15}


def instructions(program, points):
    with tempfile.TemporaryDirectory() as folder:
        out = folder + "/callgrind.out"
        subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=" + out,
                        "--toggle-collect=*growth_*", program, str(points), "once", "scanned"],
                       check=True, capture_output=True)
        text = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", out],
                              check=True, capture_output=True, text=True).stdout
    counts = {}
    for line in text.splitlines():
        found = re.match(r"\s*([\d,]+) .*\bgrowth_(\w+)\(", line)
        if found:
            counts[found.group(2)] = int(found.group(1).replace(",", ""))
    return counts


def times(program, points):
    run = subprocess.run([program, str(points), "timed", "scanned"], check=True, capture_output=True, text=True)
    return {name: float(ms) for name, ms in (line.split() for line in run.stdout.splitlines())}


def main():
    kinds = {"instructions": instructions, "ms": times}
    if sys.argv[2:] == ["instructions"]:
        del kinds["ms"]
    print(f"| stage | of | {FEW:,} | {MANY:,} | slope | at most |")
    print("| --- | --- | --- | --- | --- | --- |")
    missed = False
    for kind, measure in kinds.items():
        few, many = measure(sys.argv[1], FEW), measure(sys.argv[1], MANY)
        for stage in few:
            slope = math.log(many[stage] / few[stage]) / math.log(MANY / FEW)
            missed |= slope > MOST[kind]
            print(f"| {stage} | {kind} | {few[stage]:,} | {many[stage]:,} | {slope:.3f} | {MOST[kind]} |")
    return 1 if missed else 0


sys.exit(main())
