#!/bin/sh
# From a bare checkout to a picture: install, build, render the built-in Cornell box into out/.
# Arguments, if any, go to `chiaro render` in place of the ones chosen here.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
sh "$root/tools/build.sh"
mkdir -p "$root/out"
[ $# -gt 0 ] || set -- --spp 64 --exposure 0
"$root/build/release/chiaro" render @cornell -o "$root/out/cornell.exr" -o "$root/out/cornell.png" "$@"
echo
echo "The picture to look at:  $root/out/cornell.png"
echo "The radiance behind it:  $root/out/cornell.exr"
echo "What it should show:     $root/scenes/cornell.md"
