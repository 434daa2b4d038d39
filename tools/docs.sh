#!/bin/sh
# Makes every picture of the README and of docs/ again, by the very commands printed there: the code blocks that open with "```sh picture"
# are run from the root, with this build's chiaro first on the path. Arguments: the pages to do; default: all. DRY=1 prints the commands.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
[ -n "${DRY:-}" ] || sh "$root/tools/build.sh"
cd -- "$root"
PATH=$root/build/release:$PATH
export PATH
[ $# -gt 0 ] || set -- README.md docs/*.md
for page in "$@"; do
    commands=$(awk '/^```sh picture$/ { on = 1; next } /^```/ { on = 0 } on' "$page")
    [ -n "$commands" ] || continue
    echo "docs: $page"
    if [ -n "${DRY:-}" ]; then printf '%s\n' "$commands"; else printf '%s\n' "$commands" | sh -eu; fi
done
