//! Runs, their increments, and what they know of errors.

use std::cmp::Ordering;

use super::words::*;
use crate::report::table::{Column, Order, Row, columns};
use crate::studies::analysis::{compare_methods, compare_problems, published_times};
use crate::studies::record::{ProblemSize, Record, SolverError, Spent, Step};
use crate::studies::rows::IncrementRow;
use crate::studies::statistics::larger;
use crate::studies::why::Explanation;

/// A row about a run.
trait OfRecord {
    fn record(&self) -> &Record;
}

/// The columns that name a run, then those of the row.
fn of_record<R: OfRecord>(own: Vec<Column<R>>) -> Vec<Column<R>> {
    let mut columns = columns! { r: R,
        "id" "" = r.record().id.clone(), "stable name of the run; joins the files of a study";
        "case" "" .shown() = r.record().asked.case.clone(), "case: a shipped one, a file, or a random problem";
        "refine" "" = r.record().asked.refine, "refinement factor of the mesh";
        "mesh" "" .shown() = size(r.record()).map_or("", |size| &size.mesh), "mesh label; empty where the run ended before it had a mesh";
        "space" "" .shown() = size(r.record()).map_or(r.record().asked.space.as_deref().unwrap_or("own"), |size| &size.space), SPACE;
        "friction" "–" .named("μ") = r.record().asked.mu(), FRICTION;
        "parts" "" = r.record().asked.increments, "equal increments that each of the case's is divided in";
        "start" "" = if r.record().asked.cold { "cold" } else { "warm" }, "where methods begin an increment: from the contact forces at the end of the last one (`warm`), or from none (`cold`)";
        "method" "" .shown() = r.record().found.method.clone(), METHOD;
        "tolerance" "–" .shown() = r.record().asked.tolerance, "violation of the contact laws asked of the method and accepted by the judge";
    };
    columns.extend(own);
    columns
}

fn size(record: &Record) -> Option<&ProblemSize> {
    record.found.problem.as_ref()
}

/// Order of runs: problem, method, tolerance from coarse to fine.
pub fn compare_runs(a: &Record, b: &Record) -> Ordering {
    compare_problems(&a.asked, &b.asked)
        .then_with(|| compare_methods(&a.found.method, &b.found.method))
        .then(b.asked.tolerance.total_cmp(&a.asked.tolerance))
        .then_with(|| a.id.cmp(&b.id))
}

const STATE_CHANGES: &str =
    "changes of a point between open, stick and slip from iterate to iterate, summed";
const FINAL_CHANGES: &str =
    "points that end an increment in another state than the one they began it in";

/// A run.
pub struct RunRow<'a>(pub &'a Record);

impl OfRecord for RunRow<'_> {
    fn record(&self) -> &Record {
        self.0
    }
}

impl RunRow<'_> {
    fn error(&self, of: fn(&SolverError) -> f64) -> f64 {
        self.0.found.solver_error.as_ref().map_or(f64::NAN, of)
    }

    /// Explanation of a run that gave up, where that was asked.
    fn why(&self) -> Option<&Explanation> {
        self.0.found.why.as_ref()
    }

    /// The points that flip, with blanks between.
    fn flips(&self) -> Option<String> {
        let flips = &self.why()?.diagnosis.flips;
        let list: Vec<String> = flips.iter().map(usize::to_string).collect();
        (!list.is_empty()).then(|| list.join(" "))
    }

    fn sum(&self, counter: fn(&Step) -> usize) -> usize {
        self.0.found.sum(counter)
    }

    /// The largest over the increments; not-a-number where there is none.
    fn largest(&self, of: fn(&Step) -> f64) -> f64 {
        let all = self.0.found.increments.iter().map(of);
        all.reduce(larger).unwrap_or(f64::NAN)
    }

    /// With its kind.
    fn discretisation_error(&self) -> (f64, &str) {
        self.0.discretisation_error().unwrap_or((f64::NAN, ""))
    }

    /// √(e² + s²) of the error of the mesh and that of the solver, which are orthogonal without friction.
    fn total_error(&self, of: &Record) -> f64 {
        let solver = of.found.solver_error.as_ref();
        solver.map_or(f64::NAN, |own| {
            own.energy.hypot(self.discretisation_error().0)
        })
    }

    /// What the same to the accuracy of the case took more.
    fn saved(&self, of: impl Fn(&Record) -> f64) -> f64 {
        let beside = self.0.beside.as_deref();
        beside.map_or(f64::NAN, |fine| of(fine) - of(self.0))
    }

    /// The total error of the same to the accuracy of the case.
    fn total_error_beside(&self) -> f64 {
        let beside = self.0.beside.as_deref();
        beside.map_or(f64::NAN, |fine| self.total_error(fine))
    }

    /// A size of the problem; not-a-number where there is none.
    fn size(&self, of: fn(&ProblemSize) -> usize) -> f64 {
        size(self.0).map_or(f64::NAN, |size| of(size) as f64)
    }

    /// A time, if it may be shown.
    fn time(&self, of: fn(&Spent) -> f64) -> f64 {
        published_times(self.0).map_or(f64::NAN, of)
    }
}

/// All stages [s].
fn total(spent: &Spent) -> f64 {
    let Spent {
        setup_s,
        assembly_s,
        factorisation_s,
        condensation_s,
        ..
    } = spent;
    let method = spent.prepare.median_s + spent.solve.median_s;
    // Only studies time the output.
    let output = Some(spent.output_s).filter(|own| own.is_finite());
    setup_s + assembly_s + factorisation_s + condensation_s + method + output.unwrap_or(0.0)
}

const LOW: &str =
    "lower end of the 95 % interval of the median; of fewer than six repetitions the least";

impl Row for RunRow<'_> {
    const NAME: &'static str = "runs";
    const TITLE: &'static str = "Runs";
    const QUESTION: &'static str =
        "Which run is right, how exact is it, after how much work, in what time?";
    const NOTES: &'static str = "A row for a problem, a method and an accuracy; counters are sums over the increments of the path, violations and errors the largest of them. Times stand beside honest verdicts only, of runs that had the machine to themselves; they are medians of the repetitions.";
    const PRINTED: bool = true;
    const MOST_READ: usize = 100;
    const ORDER: Order<Self> = Order::By(|a, b| compare_runs(a.0, b.0));

    fn columns() -> Vec<Column<Self>> {
        of_record(columns! { r: Self,
            "digest" "" = r.0.asked.digest.clone(), "SHA-256 of the case file, 16 digits";
            "exact" "" = r.0.found.exact, "whether the limit of the method are the contact laws";
            "verdict" "" .shown() = &r.0.found.verdict, VERDICT;
            "cause" "" .shown() = r.0.found.cause(), CAUSE;
            "remedy" "" .shown() = r.why().and_then(|why| why.remedy.clone()), REMEDY;
            "measure" "–" .significant(3) = r.why().map(|why| why.diagnosis.measure), MEASURE;
            "period" "" = r.why().and_then(|why| why.diagnosis.period), "iterations after which a cycle repeats";
            "flips" "" = r.flips(), "contact points that change between open, stick and the directions of slip within a cycle, or while wandering, from 0";
            "rate" "–" .significant(6) = r.why().and_then(|why| why.diagnosis.rate), "`conditioning` and `slow`: factor by which an iteration reduces the violation over the last half of the run, of approximate methods the change of forces";
            "more" "" .significant(2) = r.why().and_then(|why| why.diagnosis.more), "iterations that are left at this rate";
            "solutions" "" = r.why().map(|why| why.solutions), "different solutions of the problem that are known: found by exact methods from several starts, or by trying all states of up to 8 points in the plane";
            "unique" "" = size(r.0).and_then(|size| size.unique), "`true` if each contact point alone has exactly one solution: min (W_nn − μ |W_nt|) > 0";
            "natural_map" "–" .residual().power(2) = r.largest(|i| i.judge.natural_map), NATURAL_MAP;
            "violation" "–" .residual() = r.largest(|i| i.judge.violation), "largest violation of the contact laws: what tiers and verdicts refer to";
            "overlap_m" "m" .shown().significant(2).named("overlap").power(2) = r.largest(|i| i.overlap_m), "deepest overlap of the faces anywhere, as `max_penetration_sampled`";
            "error_energy" "–" .residual() = r.error(|e| e.energy), "solver error: distance of u from the converged solution of the same discrete problem in the energy norm, relative; the largest over the increments, like the two that follow";
            "error_force" "–" .residual() = r.error(|e| e.force), "that of the contact forces";
            "error_jump" "–" .residual() = r.error(|e| e.jump), "largest difference of a jump, over the largest displacement";
            "reference" "" = r.0.found.solver_error.as_ref().map_or("", |e| &e.reference), "method that found the converged solution";
            "reference_natural_map" "–" .residual() = r.error(|e| e.reference_natural_map), "its residual";
            "discretisation_error" "–" .significant(4) = r.discretisation_error().0, "relative error of the mesh in the energy norm at the end of the path; `NaN` where nothing tells";
            "discretisation_kind" "" = r.discretisation_error().1, "`exact`: against the closed form; `estimate`: from a second mesh (`--error`), √(4/3 |ΔE|/E), with friction 0.5 to 1.2 of the true one; empty without";
            "total_error" "–" .significant(4) = r.total_error(r.0), "√(discretisation_error² + error_energy²)";
            "total_error_fine" "–" .significant(4) = r.total_error_beside(), "that of the same run to the accuracy of the case: this column and the three `saved` are of runs that the error of the mesh ends (tier `mesh`)";
            "iterations_saved" "" = r.saved(|own| own.found.sum(|i| i.iterations) as f64), "what that run took more";
            "factorisations_saved" "" = r.saved(|own| own.found.sum(|i| i.tangent_factorisations + i.global_factorisations) as f64), "dense and of K";
            "enforcement_saved_s" "s" .time() = r.saved(|own| published_times(own).map_or(f64::NAN, |s| s.enforcement.median_s)), "medians of both taken in turn; what the estimate took is not counted";
            "coarse" "" .shown() = r.0.found.coarse.iter().map(|own| format!("crack {}: {}", own.crack, own.why)).collect::<Vec<_>>().join("; "), "cracks for which the cells are too coarse: their slip and dissipation may be off by more than 3 %";
            "cell_m" "m" .shown().significant(2) = r.0.found.coarse.iter().map(|own| own.cell_m).reduce(f64::min), "cells that would do";
            "dim" "" = r.size(|size| size.dim), DIMENSION;
            "dofs" "" = r.size(|size| size.dofs), DOFS;
            "points" "" .shown() = r.size(|size| size.points), POINTS;
            "unknowns" "" = r.size(|size| size.unknowns), "contact unknowns";
            "h_m" "m" = size(r.0).map_or(f64::NAN, |size| size.h_m), CELL_WIDTH;
            "uniform_stress" "–" .residual() = size(r.0).map_or(f64::NAN, |size| size.uniform_stress), "residual of uniform stress states on the mesh, in the energy norm of a cell, found by the judge of the mesh: 0 but for rounding";
            "increments" "" .shown() = r.0.found.increments.len(), "increments that were run; the seven counters that follow are their sums";
            "iterations" "" .shown() = r.sum(|i| i.iterations), ITERATIONS;
            "solves" "" = r.sum(|i| i.solves), SOLVES;
            "tangent_factorisations" "" .named("dense factorisations") = r.sum(|i| i.tangent_factorisations), TANGENTS;
            "global_factorisations" "" = r.sum(|i| i.global_factorisations), GLOBALS;
            "local_solves" "" = r.sum(|i| i.local_solves), LOCALS;
            "state_changes" "" = r.sum(|i| i.state_changes), STATE_CHANGES;
            "final_changes" "" = r.sum(|i| i.final_changes), FINAL_CHANGES;
            "setup_s" "s" .time() = r.time(|s| s.setup_s), SETUP_S;
            "assembly_s" "s" .time() = r.time(|s| s.assembly_s), ASSEMBLY_S;
            "factorisation_s" "s" .time() = r.time(|s| s.factorisation_s), FACTORISATION_S;
            "condensation_s" "s" .time() = r.time(|s| s.condensation_s), CONDENSATION_S;
            "prepare_s" "s" .time() = r.time(|s| s.prepare.median_s), PREPARE_S;
            "solve_s" "s" .time().digits(3) = r.time(|s| s.solve.median_s), "solution of all increments";
            "solve_least_s" "s" .time() = r.time(|s| s.solve.min_s), "least of the repetitions";
            "enforcement_s" "s" .time().digits(3) = r.time(|s| s.enforcement.median_s), ENFORCEMENT_S;
            "enforcement_least_s" "s" .time() = r.time(|s| s.enforcement.min_s), "least of the repetitions";
            "enforcement_low_s" "s" .time() = r.time(|s| s.enforcement.low_s), LOW;
            "enforcement_high_s" "s" .time() = r.time(|s| s.enforcement.high_s), "upper end";
            "repetitions" "" = published_times(r.0).map_or(f64::NAN, |s| s.enforcement.samples as f64), "repetitions that times are medians of";
            "reported_s" "s" .time() = r.time(|s| s.reported.map_or(f64::NAN, |own| own.median_s)), REPORTED_S;
            "output_s" "s" .time() = r.time(|s| s.output_s), "tables and fields of the last increment, in memory; `NaN` where that was not timed";
            "total_s" "s" .time() = r.time(total), "all stages";
            "peak_mb" "MB" .significant(4) = r.time(|s| s.peak_mb.unwrap_or(f64::NAN)), "largest resident memory of the process; `NaN` where the system does not tell";
        })
    }

    fn is_honest(&self) -> bool {
        self.0.found.verdict.is_honest()
    }
}

impl OfRecord for IncrementRow<'_> {
    fn record(&self) -> &Record {
        self.record
    }
}

impl Row for IncrementRow<'_> {
    const NAME: &'static str = "increments";
    const TITLE: &'static str = "What every increment of every run found";
    const QUESTION: &'static str =
        "Which increment of a path is right, how exactly, after how much work?";
    const READABLE: bool = false;
    const ORDER: Order<Self> = Order::By(|a, b| {
        compare_runs(a.record, b.record).then(a.step.increment.cmp(&b.step.increment))
    });

    fn columns() -> Vec<Column<Self>> {
        of_record(columns! { r: Self,
            "increment" "" .shown() = r.step.increment, INCREMENT;
            "verdict" "" .shown() = &r.step.verdict, VERDICT;
            "natural_map" "–" .residual() = r.step.judge.natural_map, NATURAL_MAP;
            "iterations" "" .shown() = r.step.iterations, ITERATIONS;
            "solves" "" = r.step.solves, SOLVES;
            "tangent_factorisations" "" = r.step.tangent_factorisations, TANGENTS;
            "global_factorisations" "" = r.step.global_factorisations, GLOBALS;
            "local_solves" "" = r.step.local_solves, LOCALS;
            "state_changes" "" = r.step.state_changes, STATE_CHANGES;
            "final_changes" "" = r.step.final_changes, FINAL_CHANGES;
            "equilibrium" "–" .residual() = r.step.judge.equilibrium, "backward error of equilibrium, found by the judge: of all rows, or 1e-5 of that of the worst row";
            "claimed_equilibrium" "–" .residual() = r.step.judge.claimed_equilibrium, "the same with the consistency term of Nitsche's method, for those who claim it";
            "claimed" "–" .residual() = r.step.judge.claimed, "residual of the laws the method claims to have solved, found by the judge; `violation` where it claims the contact laws";
            "violation" "–" .residual() = r.step.judge.violation, "largest of `natural_map` and the next four columns: what tiers and verdicts refer to";
            "penetration" "–" .residual() = r.step.judge.penetration, "deepest overlap of the faces at a contact point relative to u_ref, found by the judge; no friction coefficient enters its scale";
            "adhesion" "–" .residual() = r.step.judge.adhesion, "largest tension at a contact point relative to P_ref, found by the judge";
            "complementarity" "–" .residual() = r.step.judge.complementarity, "largest product of gap and pressure at a contact point relative to u_ref and the larger of P_ref and its pressure, found by the judge";
            "cone" "–" .residual() = r.step.judge.cone, "largest excess over the friction bound at a contact point relative to P_ref, found by the judge";
            "sway" "–" .significant(2) = r.step.judge.sway, "trace of W over Σ |B_i|² / max K_jj, a measure of condition: how far contact forces move the body beside what they press into its stiffest unknowns; 0 where no point closes. Above 1e7 the mesh is suspect";
            "overlap_m" "m" .significant(2) = r.step.overlap_m, "deepest overlap of the faces anywhere, as `max_penetration_sampled`";
            "reference_force" "N or N/m" = r.step.judge.reference_force, "P_ref: contact forces that move the points as far as they move without contact, or as those at the start of the increment if that is more; 0 where no point closes";
            "reference_jump_m" "m" = r.step.judge.reference_jump_m, "u_ref: P_ref over the mean stiffness of the body against contact forces";
        })
    }
}
