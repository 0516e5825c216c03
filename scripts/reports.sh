#!/usr/bin/env bash
# Regenerates reports/: the main job, errors against exact solutions, contact spaces, random problems, and by `cargo bench` the
# timings, the study of run time against error and the page. About half an hour on two cores; the machine should do
# nothing else. An argument names parts to run instead of all: paper accuracy spaces robustness bench page.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

parts=${*:-paper accuracy spaces robustness bench page}
cargo build --locked --release
stickslip=target/release/stickslip

for part in $parts; do
    echo "== $part"
    case $part in
        paper) "$stickslip" paper --out reports ;;
        accuracy)
            "$stickslip" converge inclined_crack partial_slip partial_opening closing_crack manufactured_slip \
                manufactured_slip_rotated circular_interface --refine 1,2,4,8 --spaces star,facet,p0,edge-pairs \
                --tips none,branch,0.2 --out reports/accuracy || [[ $? == 1 ]] ;; # 1: a mesh is not solved, which the tables show
        spaces) "$stickslip" spaces --out reports/spaces ;;
        robustness) "$stickslip" stress --problems 200 --out reports/robustness ;;
        bench) cargo bench --locked ;;
        page) "$stickslip" page reports ;;
        *) echo "unknown part: $part" >&2; exit 2 ;;
    esac
done
