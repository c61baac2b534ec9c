#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs in the guest, under the host's own tools: every test that needs a kernel driver.
# Exits 1 when a test failed or was skipped: here nothing is missing, so a skip is a lie.
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=$(cat /out/build)
[ ! -e /out/environment ] || . /out/environment
failed=0
ran=0

echo "guest: $(uname -rv)"
. "$here/interfaces.sh"

for program in "$build"/vm/tests/*; do
  [ -x "$program" ] || continue
  name=$(basename "$program")
  ran=$((ran + 1))
  timeout "${PROGRAM_TIMEOUT:-300}" "$program" --gtest_output="xml:/out/$name.xml" >"/out/$name.log" 2>&1
  rc=$?
  skipped=$(grep -c 'SKIPPED' "/out/$name.log")
  passed=$(grep -c '^\[       OK' "/out/$name.log")
  if [ $rc != 0 ] || [ "$skipped" != 0 ] || [ "$passed" = 0 ]; then
    failed=1
    echo "FAILED $name: exit $rc, $skipped skipped"
    grep -E '^\[  FAILED|Failure|Which is|Expected|actual' "/out/$name.log" | head -40
  else
    echo "passed $name: $passed tests"
  fi
done

[ $ran != 0 ] || failed=1
exit $failed
