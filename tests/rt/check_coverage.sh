#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_coverage.sh BUILD: runs the tests of session and gates in a build with --coverage and fails
# unless every branch of rt/core was taken both ways. Branches that only an exception could take
# do not count: there are none in rt.
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)

find "$build" -name '*.gcda' -delete
"$build/tests/rt/core/rt_core_test" --gtest_brief=1
"$build/tests/rt/session/rt_session_test" --gtest_brief=1
report=$(gcovr --root "$root/rt/core" --object-directory "$build/rt" --exclude-throw-branches \
  --branches --fail-under-branch 100 "$build/rt")
echo "$report"
! grep -qE '^TOTAL +0 ' <<<"$report" || { echo "no branch was seen: is this a build with --coverage?"; exit 1; }
