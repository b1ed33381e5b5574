#!/usr/bin/env bash
# Fuzzes the readers for a bounded time, from the files of tests, robots and examples:
#
#   scripts/fuzz.sh                   every target for 20 s
#   scripts/fuzz.sh 300 urdf rows     these targets for 300 s each
#   SEED=7 scripts/fuzz.sh            another seed
#
# The stable compiler is enough: libFuzzer is linked as a crate, and only this project's own code is instrumented, so that
# the crates that the tests have built are used again. What is found is left in target/fuzz/found.
set -euo pipefail

# Cargo calls this script in place of the compiler.
first=${1-}
if [[ "${first##*/}" == rustc ]]; then
    instrumented=(-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4
        -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
        -Cllvm-args=-sanitizer-coverage-trace-compares)
    case " $* " in
        *" --crate-name kinstep "* | *" --crate-name kinstep_files "* | *" --crate-name kinstep_study "*)
            exec "$@" "${instrumented[@]}"
            ;;
        *) exec "$@" ;;
    esac
fi

seconds=${1:-20}
shift || true
cd "$(dirname "$0")/.."
root=$PWD
built=${CARGO_TARGET_DIR:-$root/target}
if [[ $# == 0 ]]; then set -- urdf table scenario rows; fi

# The crates of the tests, plus libFuzzer.
cp Cargo.lock fuzz/Cargo.lock
(cd fuzz && RUSTC_WRAPPER="$root/scripts/fuzz.sh" CARGO_TARGET_DIR="$built" cargo build --quiet --bins)

# The files that a target begins with.
seeds() {
    case $1 in
        urdf) find robots tests/bad_input/urdf tests/data -name '*.urdf' ;;
        table) find examples/dh crates/cli/tests/bad_input/{table,calibration} -name '*.toml' ;;
        scenario) find examples crates/cli/tests/bad_input/scenario -maxdepth 1 -name '*.toml' ;;
        rows) find examples/my_formula.toml tests/bad_input/formula -name '*.toml' ;;
        *) echo "there is no target $1; there are urdf, table, scenario and rows" >&2 && exit 2 ;;
    esac
}

found=$built/fuzz/found
mkdir -p "$found"
corpus=$(mktemp -d)
trap 'rm -rf "$corpus"' EXIT
for target in "$@"; do
    mkdir "$corpus/$target"
    seeds "$target" | while read -r file; do
        # Scenarios have an assignment in front of them.
        { [[ $target != scenario ]] || echo 'sigma=0.02'; cat "$file"; } >"$corpus/$target/${file//\//_}"
    done
    "$built/debug/$target" "$corpus/$target" -max_total_time="$seconds" -seed="${SEED:-1}" -max_len=16384 -timeout=10 \
        -rss_limit_mb=2048 -artifact_prefix="$found/$target-" -verbosity=0 -print_final_stats=1 2>&1 |
        grep -E 'executed_units|ERROR|panicked|Test unit' || true
    if compgen -G "$found/$target-*" >/dev/null; then
        echo "$target: what was found is in $found" >&2
        exit 1
    fi
    echo "$target: nothing found in $seconds s"
done
