#!/usr/bin/env bash
# Makes everything anew in results/ and keeps in reports/ what is committed: the paper's tables, summaries, provenance, a figure of
# every kind and one page. About half an hour on two cores; the machine should do nothing else. An argument names parts to run
# instead of all: paper accuracy stress random sensitivity keep.
set -euo pipefail
shopt -s nullglob
cd "$(dirname "${BASH_SOURCE[0]}")/.."

parts=${*:-paper accuracy stress random sensitivity keep}
cargo build --locked --release
stickslip=${CARGO_TARGET_DIR:-target}/release/stickslip

# What is committed of a folder: tables by name (all forms, or with .csv that one), then figures.
keep() {
    local from=results/$1 to=reports/$1 name
    shift
    mkdir -p "$to/figures"
    for name in "$@" provenance.toml; do
        case $name in
            *.svg) cp "$from"/figures/$name "$to/figures/" ;;
            *.*) cp "$from/$name" "$to/" ;;
            *) for end in csv md tex; do [[ ! -e $from/$name.$end ]] || cp "$from/$name.$end" "$to/"; done ;;
        esac
    done
    rmdir --ignore-fail-on-non-empty "$to/figures"
}

for part in $parts; do
    echo "== $part"
    case $part in
        paper) "$stickslip" paper --full --out results ;;
        accuracy)
            "$stickslip" converge inclined_crack partial_slip partial_opening closing_crack manufactured_slip \
                manufactured_slip_rotated circular_interface --refine 1,2,4,8 --spaces star,edge-pairs \
                --tips none,branch,0.2 --out results/accuracy || [[ $? == 1 ]] ;; # 1: a mesh is not solved, which the tables show
        stress) "$stickslip" stress --out results/stress || [[ $? == 1 ]] ;; # 1: a scene fails, which the tables show
        random) "$stickslip" study random --untimed --jobs 2 --out results/random ;;
        # 1: some values of some options solve nothing, which the tables show
        sensitivity) "$stickslip" study sensitivity --untimed --out results/sensitivity || [[ $? == 1 ]] ;;
        keep)
            # Written by hand: other programs on the same problems.
            find reports -mindepth 1 -maxdepth 1 ! -name peers -exec rm -r {} +
            keep . table1 table2 orders penalty convergence.csv comparison.csv \
                expectations.csv cost.svg \
                'beam_model1.6x18x9.edge-pairs.*.mu-0.1.state.svg' 'penny_crack.*.state.svg' \
                'plate_mesh1.22x22.edge-pairs.mu-0.8.residual.svg' 'partial_slip.10x10.star.mu-0.5.crack-1.profile.svg' \
                'partial_slip_cycle.*.crack-1.loop.svg' 'plate_mesh1.22x22.edge-pairs.*.mu-0.1.state.svg' \
                'time_against_total_error.plate_mesh1*.svg'
            keep accuracy orders.csv 'partial_slip.*.energy.error.svg'
            keep stress stress_scenes stress_invariances stress_ladders success success.svg
            cp -r results/stress/cases reports/stress/
            keep random success causes stopping success.svg
            keep sensitivity options options.svg
            keep study ranking scaling success runs.csv profile.time.svg 'scaling.*.svg' \
                'time_against_solver_error.plate_mesh1*mu-0.8.svg' 'time_against_total_error.partial_slip.*.svg'
            "$stickslip" show reports ;;
        *) echo "unknown part: $part" >&2; exit 2 ;;
    esac
done
