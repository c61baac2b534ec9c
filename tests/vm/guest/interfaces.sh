# SPDX-License-Identifier: Apache-2.0
# Sourced in the guest: one CAN interface of each kind, virtual, a pair, and an emulated controller's pair.
ip link add dev vcan0 type vcan && ip link set vcan0 mtu 72 && ip link set vcan0 up
ip link add dev vxcan0 type vxcan peer name vxcan1 && ip link set vxcan0 mtu 72 &&
  ip link set vxcan1 mtu 72 && ip link set vxcan0 up && ip link set vxcan1 up
for controller in can0 can1; do
  ip link set "$controller" type can bitrate 500000 && ip link set "$controller" up
done
