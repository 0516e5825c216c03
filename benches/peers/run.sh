#!/usr/bin/env bash
# Exports the problems, runs stickslip and all peers on them, and writes the tables of reports/peers into OUT.
#   benches/peers/run.sh OUT [PYTHON_WITH_PIN]
# Needs Debian's python3-siconos, python3-h5py and python3-scipy, and for Pinocchio a Python with `pin` and `h5py`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=$1
python_with_pin=${2:-python3}
stickslip=${STICKSLIP:-target/release/stickslip}

problem() {
    "$stickslip" export "$@" --out "$out/problems"
}

mkdir -p "$out"
for friction in 0.1 0.8 1.2; do problem plate_mesh1 --friction $friction; done
problem plate_mesh1 --friction 0.8 --refine 8
problem plate_mesh2 --friction 0.8
for increment in 3 4; do problem cyclic --increment $increment; done
for case in partial_slip inclined_crack circular_interface closing_crack partial_opening; do problem $case; done
problem benches/scale/plate_400.toml
for case in penny_crack elliptic_crack; do problem $case; done
for case in partial_slip inclined_crack; do problem $case --refine 4; done
problem beam_model1 --friction 0.1
problem beam_model1 --friction 0.1 --refine 2
problem beam_model2 --friction 0.1
problem benches/scale/cube_30.toml
problem benches/peers/slab.toml
sed 's/^friction = 0.5$/friction = 0.1/' benches/peers/slab.toml > "$out/slab_slippery.toml"
problem "$out/slab_slippery.toml"

# Few repeats where a call takes a second.
small=() large=()
for file in "$out"/problems/*.local.hdf5; do
    case $file in
        */slab*) large+=("$file") ;;
        *) small+=("$file") ;;
    esac
done
"$stickslip" solve "${small[@]}" --repeats 50 --out "$out/ours" || true
# The others take minutes there.
"$stickslip" solve "${large[@]}" -m hybrid -m pdas --repeats 3 --out "$out/ours_large" || true
{ cat "$out/ours/runs.csv"; tail -n +2 "$out/ours_large/runs.csv"; } > "$out/runs.csv"
/usr/bin/python3 benches/peers/siconos.py "${small[@]}" "${large[@]}" --repeats 50 --out "$out"
"$python_with_pin" benches/peers/pinocchio.py "${small[@]}" "${large[@]}" --repeats 50 --out "$out"
/usr/bin/python3 benches/peers/compare.py "$out/problems" "$out/runs.csv" "$out/siconos.csv" "$out/pinocchio.csv" --out "$out"
