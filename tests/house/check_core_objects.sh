#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_core_objects.sh NM OBJDUMP LIBRARY: the objects of the point-cloud core, which promise the
# same bits everywhere, hold no fused multiply-add and take from outside no more than memory
# functions: no heap, thread, exception, file or mathematics library.
set -euo pipefail
nm=$1 objdump=$2 library=$3

core='cell_runs|cell_tree|curve_order|grid_batch|grid_index|near_points|voxel_hash|unproject|crop_box|frame_fuser|normals|organized_normals|orientation|outlier_removal|radius_outlier_removal|voxel_downsample|voxel_map|symmetric_eigen3|boundary'
allowed='^(mem(cpy|move|set|cmp)|sqrtf?|floorf?|__stack_chk_fail|__popcount[sdt]i2|_GLOBAL_OFFSET_TABLE_|_ZNK?5dseam.*)$'

"$nm" -A --undefined-only --format=posix "$library" 2>/dev/null |
  awk -v core="[\\[](${core})[.]cpp" -v allowed="$allowed" '
    $1 ~ core && $2 !~ allowed { print $1, "asks for", $2; bad = 1 }
    END { exit bad }'

"$objdump" -d --no-show-raw-insn "$library" |
  awk -v core="^(${core})[.]cpp" '
    /file format/ { object = $1; is_core = (object ~ core); seen += is_core }
    is_core && $2 ~ /^(vfn?m(add|sub)|fn?m(add|sub)$|fml[as]$)/ { print object, $0; bad = 1 }
    END { if (seen < 17) { print "only", seen, "objects found"; bad = 1 } exit bad }'
