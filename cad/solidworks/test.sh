#!/bin/sh
# Compiles the sources of the add-in's project against stubs with Mono, and runs them with recording stubs: test.sh [JOINTPLAY [LIBRARY]]
set -eu
command=${1:+$(realpath "$1")}
library=${2:+$(realpath "$2")}
cd "$(dirname "$0")"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
sources=$(sed -n 's/.*<Compile Include="\([^"]*\)".*/\1/p' Jointplay.SolidWorks.csproj | tr '\\' '/')
# shellcheck disable=SC2086
mcs -warnaserror+ -nowarn:1591 -out:"$folder/tests.exe" Stubs.cs $sources PlaybackTests.cs AddInTests.cs
set --
if [ -n "$command" ]; then
    "$command" move gpr-mechanism --drive "rod 1=0:3.1" --drive "rod 2=0:-1.55" --drive "rod 3=0:-1.55" --poses --steps 20 --out "$folder/motion" --quiet >/dev/null
    set -- "$folder/motion/gpr-mechanism-motion.csv"
fi
if [ -n "$library" ]; then
    ln -s "$library" "$folder/libjointplay.so"
    set -- "$@" "$(realpath ../../crates/jointplay-format/robots/gpr-mechanism.toml)"
fi
LD_LIBRARY_PATH="$folder" mono "$folder/tests.exe" "$@"
