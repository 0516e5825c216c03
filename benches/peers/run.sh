#!/usr/bin/env bash
# Exports the problems, runs stickslip and all peers on them and on further FCLIB files, and writes the tables of reports/peers into OUT/tables.
#   benches/peers/run.sh OUT [FILE ...]
# Needs gcc and Debian's python3-siconos, python3-h5py, python3-scipy and python3-matplotlib, and for Pinocchio PIN, a Python with
# `pin`, `h5py` and `scipy`. OUT must be new: rows are added to tables.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
out=$1
shift
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

for file in "$@"; do
    name=$(basename "$file" .hdf5)
    /usr/bin/python3 benches/peers/peer.py "$file" "$out/problems/${name%.local}.local.hdf5"
done
# One file after the other by all programs, so that drift of the machine meets them alike.
for file in "$out"/problems/*.local.hdf5; do
    name=$(basename "$file" .hdf5)
    solvers=() methods=() limit=20 repeats=50
    # The others do not get there in a minute, or take many.
    case $name in slab*)
        solvers=(--solver ADMM --solver NSN_AC_HYBRID --solver NSN_AC_TEST_PLAIN --solver NSGS_LIGHT)
        methods=(-m hybrid -m pdas -m newton-ac) limit=60 repeats=3 ;;
    esac
    /usr/bin/python3 benches/peers/siconos.py "$file" "${solvers[@]}" --repeats 50 --limit $limit --out "$out"
    "$stickslip" solve "$file" "${methods[@]}" --repeats $repeats --time-limit $limit --quiet --out "$out/ours/$name" || true
    case $name in slab*) ;; *) ${PIN:-true} benches/peers/pinocchio.py "$file" --repeats 50 --limit $limit --out "$out" ;; esac
done
# How small a natural map can be had.
{
    printf 'title = "Success"\n[[cells]]\ntolerances = [1e-12]\n'
    printf 'methods = ["hybrid", "ipm-anm", "newton-ac", "pdas", "gnm", "b-newton"]\nfiles = [\n'
    (cd "$out" && printf '    "%s",\n' problems/*.local.hdf5)
    printf ']\n'
} > "$out/success.toml"
"$stickslip" study "$out/success.toml" --untimed --time-limit 20 --quiet --out "$out/ours/success" || true
/usr/bin/python3 benches/peers/compare.py "$out" --out "$out/tables"
