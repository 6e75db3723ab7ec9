#!/bin/bash
# Runs inside the QEMU guest: guest.sh STATE, where STATE is the folder tests/vm/run prepared.
# can0 and can1 are two controllers on one wire, can2 and can3 two for CAN FD on another. A test of the daemon
# gives it can0 or can2 and puts simulated drives on can1 or can3.
set -euo pipefail

state=$1
arguments=(tests/vm)
# shellcheck source=/dev/null
. "$state/environment"
export RC10_GUEST=vm RC10_SCRATCH=$state
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$RC10_REPO/tests/kernel

modprobe -a can-raw can-dev kvaser_pci
insmod "$RC10_CAN_MODULES/ctucanfd.ko"
insmod "$RC10_CAN_MODULES/ctucanfd_pci.ko"
for bus in can0 can1; do
    ip link set "$bus" type can bitrate 1000000 restart-ms 0
    ip link set "$bus" up
done
# LCM's multicast group leaves by lo only.
ip link set lo up
ip route add 239.255.76.67/32 dev lo src 127.0.0.1

cd "$RC10_REPO"
"$RC10_PYTHON" -m pytest -p no:cacheprovider -v --color=no \
    --junitxml="$state/report.xml" "${arguments[@]}"
