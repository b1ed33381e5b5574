#!/usr/bin/env bash
# Plans the example with two arms, writes it in every format, and has independent programs read it back.
# Usage: scripts/read_back.sh [PATH TO kinstep]; without a path the program is built. Prints its seconds.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-}
if [ -z "$program" ]; then
    cargo build --quiet --all-features
    program=${CARGO_TARGET_DIR:-target}/debug/kinstep
fi
begin=$SECONDS
venv=${CARGO_TARGET_DIR:-target}/read_back_venv
wanted=scripts/read_back_requirements.txt
# The environment is made again when the versions change, or when making it was cut short.
if ! cmp --quiet "$wanted" "$venv/made_from.txt"; then
    rm -rf "$venv"
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --requirement "$wanted"
    cp "$wanted" "$venv/made_from.txt"
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" plan examples/dual_panda.toml --out "$folder" --format all --json >/dev/null
"$venv/bin/python" scripts/read_back.py "$folder"
echo "read back in $((SECONDS - begin)) s"
