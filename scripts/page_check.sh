#!/usr/bin/env bash
# Opens pages of `kinstep plan --out` in a browser and looks whether they do what docs/report.md says.
# Installs what is missing (as root, on Debian): chromium, node with npm, and playwright-core into a temporary folder.
#   scripts/page_check.sh [FOLDER FOR SCREENSHOTS]
# KINSTEP names the program, if it is not to be built.
set -euo pipefail
cd "$(dirname "$0")/.."

desk=$(mktemp -d)
trap 'rm -rf "$desk"' EXIT
[ $# -eq 0 ] || mkdir -p "$1"

begin=$SECONDS
needed=()
[ -x /usr/bin/chromium ] || needed+=(chromium)
command -v node >/dev/null || needed+=(nodejs)
command -v npm >/dev/null || needed+=(npm)
if [ ${#needed[@]} -gt 0 ]; then
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${needed[@]}" fonts-dejavu-core >/dev/null
fi
npm install --prefix "$desk" --silent --no-audit --no-fund playwright-core@1 >/dev/null
cp scripts/page_check.mjs "$desk/"
echo "installed what was missing in $((SECONDS - begin)) s"

begin=$SECONDS
kinstep=${KINSTEP:-}
if [ -z "$kinstep" ]; then
    cargo build --quiet --all-features
    kinstep=${CARGO_TARGET_DIR:-target}/debug/kinstep
fi
plan() {
    local name=$1 expected=$2 code=0
    shift 2
    "$kinstep" plan "$@" --out "$desk/$name" >/dev/null || code=$?
    [ "$code" = "$expected" ] || { echo "$name: exit $code, expected $expected"; exit 1; }
}
plan dual_panda 0 examples/dual_panda.toml
plan planar_dual 0 examples/planar_dual.toml
plan shared_torso 0 examples/shared_torso.toml
plan stopped 5 examples/planar_dual.toml --set arm.left.path.radius=1.5
# This one stops where it starts.
plan singular 5 examples/planar_dual.toml --set 'arm.left.q0=[0, 0, 0, 0]'
plan long 0 examples/planar_dual.toml --set sigma=0.0001
echo "planned in $((SECONDS - begin)) s"

begin=$SECONDS
# What the command line says of where a tip is, for the page to agree with.
"$kinstep" robot fk panda --base panda_link0 --tip panda_hand_tcp --q=0,-pi/4,0,-3*pi/4,0,pi/2,pi/4 --json >"$desk/tip.json"
node "$desk/page_check.mjs" "$desk" "$@"
echo "looked at in $((SECONDS - begin)) s"
