#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# check.sh MODEL.pml: searches every state of the model; prints what spin found. Where the model
# has mutants, each of them breaks one of its rules, and the search must find that.
# SPDX-License-Identifier: Apache-2.0
set -eu
model=$(readlink -f "$1")
mutants=$(sed -n 's/^#define MUTANTS //p' "$model")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"

search() { # search MUTANT: the result is in ./result
  spin -a -DMUTANT="$1" "$model" >/dev/null
  "${CC:-cc}" -O2 -DSAFETY -DNOREDUCE -o pan pan.c
  ./pan -m100000 -E >result
}

search 0
grep -E 'errors:|states, stored' result
grep -q 'errors: 0' result
! grep -qi 'search depth too small\|max search depth' result
for mutant in $(seq 1 "${mutants:-0}"); do
  search "$mutant"
  if grep -q 'errors: 0' result; then
    echo "mutant $mutant of $model is not found: an assertion cannot fail"
    exit 1
  fi
  echo "mutant $mutant: $(sed -n 's/^pan:1: //p' result)"
done
