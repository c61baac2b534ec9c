#!/bin/sh
# check.sh MODEL.pml: searches every state of the model; prints what spin found.
# SPDX-License-Identifier: Apache-2.0
set -eu
model=$(readlink -f "$1")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
spin -a "$model" >/dev/null
"${CC:-cc}" -O2 -DSAFETY -DNOREDUCE -o pan pan.c
./pan -m100000 -E >result
grep -E 'errors:|states, stored' result
grep -q 'errors: 0' result
! grep -qi 'search depth too small\|max search depth' result
