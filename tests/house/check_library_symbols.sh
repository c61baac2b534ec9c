#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_library_symbols.sh NM LIBRARY: all that lib/ takes from outside is memory functions and
# mathematics. No heap, exception, thread, file, clock, output or operating system: a microcontroller
# without any of them links it.
set -euo pipefail
nm=$1 library=$2

memory='mem(cpy|move|set|cmp)'
mathematics='(sqrt|floor|ceil|round|trunc|fabs|fmin|fmax|fmod|hypot|cbrt|log|log1p|log2|exp|expm1|pow|sin|cos|tan|sincos|asin|acos|atan|atan2|lround|copysign|remainder|erf|erfc)f?'
compiler='__stack_chk_fail|__popcount[sdt]i2|_GLOBAL_OFFSET_TABLE_|__cxa_pure_virtual|_ZTV.*'
allowed="^(${memory}|${mathematics}|${compiler}|_Z[A-Z]*N[VKRO]*5dseam.*)\$"

defined() { "$nm" --defined-only --format=posix "$library" 2>/dev/null | awk 'NF > 1 { print $1 }'; }

"$nm" -A --undefined-only --format=posix "$library" 2>/dev/null |
  awk -v allowed="$allowed" '
    NR == FNR { defined[$1]; next }
    { seen++ }
    !($2 in defined) && $2 !~ allowed { print $1, "asks for", $2; bad = 1 }
    END { if (seen < 100) { print "only", seen + 0, "symbols found"; bad = 1 } exit bad }' <(defined) -
