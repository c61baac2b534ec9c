#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# main_job.sh BUILD, in the guest: `dseam weld` in one process and `dseam robot` in another, with
# the kernel's CAN in between.
set -u
dseam=$1/examples/dseam/dseam
player=$1/vm/counted/vivid_player
set=$1/vm/scan-set
failed=0

start_robot() {
  "$dseam" robot --can vcan0 >"/out/$1-robot.log" 2>&1 &
  robot=$!
  until grep -q 'Ctrl-C' "/out/$1-robot.log"; do sleep 0.1; done
}
end_robot() {
  kill -INT $robot
  wait $robot
}
of_robot() { sed -n "s/.*$2.*/\\1/p" "/out/$1-robot.log"; }

of_report() { sed -n "s/.*\"$2\": *\"\\([0-9]*\\)\".*/\\1/p" "/out/$1/report.json"; }

# judge NAME TEXT CONDITION...
judge() {
  local name=$1 text=$2
  shift 2
  if [ "$@" ]; then
    echo "passed main job, $name: $text"
  else
    failed=1
    echo "FAILED main job, $name: $text; not $*"
    tail -20 "/out/$name.log"
  fi
}

# whole NAME OPTION...: the host must end well and the robot must have executed all that was sent.
whole() {
  local name=$1 rc sent executed
  shift
  start_robot "$name"
  timeout 300 "$dseam" weld "$@" --robot can:vcan0 --out "/out/$name" >"/out/$name.log" 2>&1
  rc=$?
  end_robot
  sent=$(($(of_report "$name" 'set points sent') - $(of_report "$name" 'set points sent again')))
  executed=$(of_robot "$name" 'executed \([0-9]*\) set points')
  judge "$name" "exit $rc, $sent set points sent, $executed executed" \
    $rc = 0 -a "$sent" -gt 0 -a "$sent" = "${executed:-none}"
}

# broken SIGNAL OPTION...: the signal comes while the arc burns; the robot must have been told.
broken() {
  local name=$1 rc robot_says
  shift
  start_robot "$name"
  "$dseam" weld "$@" --robot can:vcan0 --out "/out/$name" >"/out/$name.log" 2>&1 &
  local host=$!
  until [ "$(sed -n 's/^welding: \([0-9]*\) of.*/\1/p' "/out/$name.log" | tail -1)0" -gt 10000 ]; do
    kill -0 $host || break
    sleep 0.1
  done
  kill "-$name" $host
  wait $host
  rc=$?
  end_robot
  robot_says=$(of_robot "$name" 'arc \(.*\)')
  judge "$name" "exit $rc, arc $robot_says" "$robot_says" = "off, link fault Aborted" -a $rc != 0
}

# The views of the set are shown to two cameras of the kernel's, the depth to one and the gray to the
# other, as if a robot had driven the camera to its taught poses.
vivid() {
  touch /out/vivid.log
  "$player" "$set" /out/vivid.log >/out/player.log 2>&1 &
  local shown=$!
  until [ -s /out/player.log ]; do sleep 0.1; done
  whole vivid --camera v4l2:/dev/video0 --set 'camera.gray_device="/dev/video2"' --set 'camera.format="Y16"' \
    --set camera.width=1280 --set camera.height=720 --set camera.mm_per_count=0.015625 \
    --set camera.focal_px=2048 --set camera.settle_s=0.5 \
    --set "camera.poses=\"$set/scene_camera.json\"" --set path.speed_mm_s=16
  kill $shown || { failed=1; echo "FAILED main job, vivid: $(tail -1 /out/player.log)"; }
}

whole replay --camera "replay:$set" --set path.speed_mm_s=16
vivid
broken INT --camera "replay:$set"
exit $failed
