#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs in a guest whose time is counted in instructions, so that the host's load does not show:
# the latencies of camera, cycle and bus, and the main job in two processes on one bus.
set -u
here=$(cd "$(dirname "$0")" && pwd)
build=$(cat /out/build)
. "$here/interfaces.sh"

"$build/vm/counted/latency_test" >/out/latency.log 2>&1 || { cat /out/latency.log; exit 1; }
grep '^LATENCY' /out/latency.log | tee /out/latencies
[ -e /out/main-job ] || exit 0
"$here/main_job.sh" "$build"
