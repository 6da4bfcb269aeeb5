#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a check where it fits into the time that is left, and says so where it does not run:
#
#     scripts/run_with_time_limit.sh NAME LIMIT USED NEEDED COMMAND ...
#
# In seconds: what everything together may take, what it has taken so far, what the command is known to take. The
# command is skipped if it would not end in time or cannot run here, which it says with exit status 75 and a last
# line that names the reason; it is ended at the limit. Exit status 0 for passed and skipped, else that of the command.
set -euo pipefail

name=$1 limit=$2 used=$3 needed=$4
shift 4
left=$((limit > used ? limit - used : 0))

minutes() { echo "$((($1 + 30) / 60)) min"; }

skip() {
  echo "$name skipped: $1"
  exit 0
}

((left >= needed)) ||
  skip "takes about $(minutes "$needed"), $(minutes "$used") of $(minutes "$limit") are used"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
timeout --kill-after=60 "$left" "$@" 2>&1 | tee "$log" || status=${PIPESTATUS[0]}
case $status in
  0) echo "$name passed" ;;
  75) skip "$(tail -n 1 "$log")" ;;
  124 | 137) skip "not ended after $(minutes "$left"), all that was left of $(minutes "$limit")" ;;
  *) echo "$name FAILED ($status)" && exit "$status" ;;
esac
