#!/bin/sh
# Compiles the playback against stubs with Mono, and runs it with recording stubs: test.sh JOINTPLAY
set -eu
[ $# -gt 0 ] && set -- "$(realpath "$1")"
cd "$(dirname "$0")"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mcs -warnaserror+ -out:"$folder/tests.exe" Stubs.cs Playback.cs PlaybackTests.cs
if [ $# -gt 0 ]; then
    "$1" move gpr-mechanism --drive "rod 1=0:3.1" --drive "rod 2=0:-1.55" --drive "rod 3=0:-1.55" --poses --steps 20 --out "$folder/motion" --quiet >/dev/null
    mono "$folder/tests.exe" "$folder/motion/gpr-mechanism-motion.csv"
else
    mono "$folder/tests.exe"
fi
