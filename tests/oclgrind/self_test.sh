#!/bin/sh
# Shows that run.sh notices each kind of wrong kernel, and lets a right one pass.
#   tests/oclgrind/self_test.sh PROGRAM FOLDER   (PROGRAM: faulty_kernel.cpp; FOLDER: for the logs)
set -u
program=$1
folder=$2
here=$(dirname "$0")
failed=0
mkdir -p "$folder"
# Name of the case, status expected of run.sh, words expected in its output.
check() {
    "$here/run.sh" "$folder/$1.log" "$program" "$1" >"$folder/$1.out" 2>&1
    status=$?
    if [ "$status" -ne "$2" ] || ! grep -q "$3" "$folder/$1.out"; then
        echo "self_test.sh: $1 ended run.sh with status $status; expected $2 and the words '$3':" >&2
        cat "$folder/$1.out" >&2
        failed=1
    fi
}
check right 0 'launched'
check out_of_bounds_read 99 'Invalid read'
check out_of_bounds_write 99 'Invalid write'
check out_of_bounds_local 99 'Invalid write'
check race_global 99 'data race'
check race_local 99 'data race'
check uninitialised 99 'Uninitialized'
check program_fails 7 'launched'
exit "$failed"
