#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# fleet.sh ODOGRAPH SOURCE [PROFILE]: a small fleet, killed after some rows and resumed, gives the same table and
# report as an uninterrupted one. PROFILE slurm: on the cluster of sbatch, with TMPDIR visible to all nodes.
set -eu
odograph=$1 source=$2 profile=${3:-local}
command -v snakemake > /dev/null || { echo "SKIPPED: no snakemake"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$source/samples" "$work/samples"
cd "$work"
cat > small.yaml << END
odograph: $odograph
configs: {weinberg2002: samples/configs/phone_walk.yaml, odograph: samples/configs/phone_walk_odograph.yaml}
data: .
recordings: {}
simulated:
  surveyor: {scenario: samples/fleet/surveyor.yaml, first: 1, walks: 3}
  tall: {scenario: samples/fleet/tall.yaml, first: 101, walks: 2}
END
fleet() {
  [ "$profile" != local ] || set -- "$1" --cores 2
  exec setsid snakemake -s samples/fleet/Snakefile --profile "samples/fleet/profiles/$profile" ${2:+"$2" "$3"} --config fleet=small.yaml out="$1" > "$1.log" 2>&1
}
(fleet whole) || { tail -30 whole.log; exit 1; }
fleet killed &
pid=$!
for _ in $(seq 600); do
  [ "$(find killed/rows -name '*.json' 2>/dev/null | wc -l)" -lt 3 ] || break
  sleep 0.1
done
kill -KILL "-$pid"
wait "$pid" || true
[ "$profile" != slurm ] || scancel --name=odograph
rows=$(find killed/rows -name '*.json' | wc -l)
[ "$rows" -lt 10 ] || { echo "it was done before it was killed"; exit 1; }
[ ! -e killed/table.csv ]
snakemake -s samples/fleet/Snakefile --config fleet=small.yaml out=killed --cores 1 --unlock > unlock.log 2>&1
(fleet killed) || { tail -30 killed.log; exit 1; }
cmp whole/table.csv killed/table.csv
cmp whole/report.md killed/report.md
[ "$(wc -l < whole/table.csv)" = 11 ]
! grep -q failure whole/table.csv
echo "killed after $rows rows of 10, resumed: the same table"
