#!/bin/sh
# Runs a program under oclgrind and fails when oclgrind reports anything at all: an invalid access,
# a data race, a use of uninitialised memory. oclgrind itself ends with the program's status.
#   tests/oclgrind/run.sh LOGFILE PROGRAM [ARGUMENTS...]
# Status: the program's own if that is not 0, 99 after a report, 98 where oclgrind is missing.
set -u
if [ $# -lt 2 ]; then
    echo "usage: run.sh LOGFILE PROGRAM [ARGUMENTS...]" >&2
    exit 2
fi
log=$1
shift
if ! command -v oclgrind >/dev/null 2>&1; then
    echo "run.sh: oclgrind is not installed" >&2
    exit 98
fi
rm -f "$log"
# What to check for. With --uninitialized oclgrind 21.10 breaks down in kernels that work on vectors, or reports lanes
# that are set: (uint2)(a, b) stored whole is enough. Those kernels are checked without it.
checks=${CLINCH_OCLGRIND_CHECKS:---data-races --uninitialized}
# shellcheck disable=SC2086  # the checks are words of their own
oclgrind $checks --log "$log" "$@"
status=$?
if [ -s "$log" ]; then
    echo "run.sh: oclgrind reports:" >&2
    head -n 60 "$log" >&2
    [ "$status" -ne 0 ] || status=99
fi
exit "$status"
