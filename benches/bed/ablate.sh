#!/bin/sh
# What each rule of the optimiser is worth: `benches/bed/ablate.sh [METHOD [TEXT]]` changes one rule
# after the other in a copy of the sources, runs the bed and prints what it solves. METHOD is
# InteriorPoint, TrustRegion or Auto; TEXT selects rules by name. The list is `ablations.txt`: name,
# file below src/optimiser, and an expression of sed that must change the file.  NULL=1 makes the first null change.
set -eu
cd "$(dirname "$0")/../.."
method=${1:-InteriorPoint}
only=${2:-}
copy=${COPY:-$(mktemp -d)}
cp -r Cargo.toml Cargo.lock src benches tests examples "$copy"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$copy/target}"
run() {
    (cd "$copy" && ${BED:-cargo bench --quiet --bench bed --} --method "$method" --null "${NULL:-0}" 2>/dev/null) >"$copy/out"
    of() { awk -v group="$1" -v method="$method" '$1 == group && $2 == method {print $'"$2"'}' "$copy/out"; }
    lost=$(grep -A1 '^was .*,Solved,' "$copy/out" | sed -n 's/^now \([^,]*\),.*/\1/p' | paste -sd';' -)
    gained=$(sed -n 's/^now \([^,]*\),[^,]*,Solved,.*/\1/p' "$copy/out" | paste -sd';' -)
    echo "| $1 | $(of all 3) | $(of all 6) | $(of all 7) | $(of HS 7) | ${lost:--} | ${gained:--} |"
}
echo "| $method without | solved | false | f + g | Hock–Schittkowski | lost | gained |"
echo "|---|---|---|---|---|---|---|"
run "nothing"
grep -v '^#' benches/bed/ablations.txt | grep -- "$only" | while IFS='|' read -r name file expression; do
    sed "$expression" "src/optimiser/$file" >"$copy/src/optimiser/$file"
    if cmp -s "src/optimiser/$file" "$copy/src/optimiser/$file"; then
        echo "nothing to change for: $name" >&2
        exit 1
    fi
    run "$name"
    cp "src/optimiser/$file" "$copy/src/optimiser/$file"
done
