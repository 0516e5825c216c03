//! The verb `spaces`: what the contact spaces are worth, whatever method works on them.

use super::arguments::Output;
use super::error::CliError;
use super::output::{say, show, warn};
use super::progress::Bar;
use crate::case::ContactSpace;
use crate::report::tables::spaces::{InfSupSummary, PatchSummary};
use crate::report::{Plan, Provenance, spaces as report};
use crate::run::choice::Choice;
use crate::studies::spaces::infsup::{self, SCENES, Scene};
use crate::studies::spaces::patch::{self, PatchRow};

/// Arguments of the verb.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Meshes of every sequence, from the coarsest: a slope needs three
    #[arg(long, default_value_t = most_meshes() as u8, value_parser = clap::value_parser!(u8).range(3..=most_meshes() as i64))]
    meshes: u8,
    /// Distances of the crack from a node in the patch tests, of 27 from 0.3 cells down to 0
    #[arg(long, default_value_t = patch::DISTANCES.len() as u8, value_parser = clap::value_parser!(u8).range(1..=patch::DISTANCES.len() as i64))]
    distances: u8,
    #[command(flatten)]
    output: Output,
}

/// Meshes of the longest sequence.
fn most_meshes() -> usize {
    SCENES.iter().map(|s| s.cells.len()).max().unwrap_or(0)
}

/// Runs the study; false if `star`, which is stable by construction, is not found to be.
pub fn run(arguments: Arguments, plan: Plan) -> Result<bool, CliError> {
    let claim = arguments.output.claim("spaces", plan)?;
    let bar = Bar::new();
    let meshes = usize::from(arguments.meshes);
    let cells = |scene: &Scene| scene.cells.iter().copied().take(meshes).collect();
    let sequences = infsup::run(cells, &bar)?;
    bar.finish();
    let bar = Bar::new();
    // A method that takes whatever contact state comes.
    let choice = Choice::parse("hybrid")?;
    let distances = usize::from(arguments.distances);
    let patches = patch::catalogue(&patch::DISTANCES[..distances])?;
    let rows = patch::run(&patches, &ContactSpace::stable_first(), &choice, &bar)?;
    bar.finish();

    let provenance = Provenance::collect(rayon::current_num_threads())
        .with_option("meshes", meshes.to_string())
        .with_option("distances", distances.to_string());
    claim.commit(&report::bundle(&sequences, &rows, &provenance)?)?;
    let stability: Vec<InfSupSummary> = sequences.iter().map(InfSupSummary).collect();
    show(&stability, "");
    let passed = PatchSummary::of(&rows);
    show(&passed, "");
    let failed = || {
        let star = |s: &&infsup::Sequence| s.space == ContactSpace::Star && !s.is_stable();
        sequences.iter().filter(star)
    };
    let stable = sequences.iter().filter(|s| s.is_stable()).count();
    say(format_args!(
        "{} sequences: {stable} stable, {} not\nResults: {}",
        sequences.len(),
        sequences.len() - stable,
        claim.dir().display()
    ));
    for s in failed() {
        warn(format_args!(
            "not stable: {} on {}: slope {:.2}, share {:.2}",
            s.space.name(),
            s.scene.name,
            s.slope,
            s.share
        ));
    }
    let missed: Vec<&PatchRow> = rows
        .iter()
        .filter(|row| row.space == ContactSpace::Star.name() && !row.passed())
        .collect();
    for row in &missed {
        warn(format_args!(
            "patch test missed: star on {} of {}, {}, at {:e} of a cell: {}, traction {:.1e}, displacement {:.1e}",
            row.crack,
            row.mesh,
            row.state.name(),
            row.distance,
            row.verdict,
            row.traction,
            row.displacement
        ));
    }
    Ok(failed().next().is_none() && missed.is_empty())
}
