#!/bin/sh
# From a bare checkout to a picture: install, build, render the built-in Cornell box into out/, and compare two ways of sampling it.
# Arguments, if any, go to `chiaro render` in place of the ones chosen here.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
sh "$root/tools/build.sh"
mkdir -p "$root/out"
[ $# -gt 0 ] || set -- --spp 64
"$root/build/release/chiaro" render @cornell -o "$root/out/cornell.exr" -o "$root/out/cornell.png" "$@"
echo
echo "Do light samples alone and light samples weighted with BSDF samples make the same picture?"
"$root/build/release/chiaro" agree @cornell -i path:mis=off --size 48x48 --spp 64 --replicates 16 --quiet
echo
echo "The picture to look at:  $root/out/cornell.png"
echo "The radiance behind it:  $root/out/cornell.exr"
echo "What it should show:     $root/scenes/cornell.md"
