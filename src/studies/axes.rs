//! Problems times what is asked of them: tasks.

use std::sync::Arc;

use crate::case::{Case, ContactSpace, Tip};
use crate::run::choice::Choice;
use crate::run::verdict::Accuracy;
use crate::studies::task::{Asked, FROM_FILE, Looks, Matter, Named, Task, digest};
use crate::studies::tips::name;

/// A problem as its source yields it.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Name of the case, or of the problem of a file.
    pub name: String,
    /// Its group, for statistics; empty: none.
    pub class: String,
    /// Where it is described.
    pub matter: Arc<Matter>,
    /// As in [`Asked::digest`].
    pub digest: String,
}

/// Axes that a problem is combined with.
#[derive(Debug, Clone)]
pub struct Axes {
    /// Refinement factors.
    pub refine: Vec<usize>,
    /// Contact spaces; none: the case's own.
    pub spaces: Vec<Option<String>>,
    /// Enrichments of tips; none: the case's own.
    pub tips: Vec<Option<String>>,
    /// Friction coefficients, by crack.
    pub friction: Vec<Vec<f64>>,
    /// Equal parts of every increment.
    pub increments: Vec<usize>,
    /// Whether every increment begins from no contact forces.
    pub cold: Vec<bool>,
}

impl Subject {
    /// The texts of cases with the names of their files.
    pub fn texts(cases: &[Case]) -> Vec<(String, String)> {
        let all = cases.iter().map(Self::of);
        all.filter_map(|own| own.text()).collect()
    }

    /// Text of the case with the name of its file; none of a problem file.
    pub fn text(&self) -> Option<(String, String)> {
        match &*self.matter {
            Matter::Case { text, .. } => Some((format!("{}.toml", self.name), text.clone())),
            _ => None,
        }
    }

    /// A case.
    pub fn of(case: &Case) -> Self {
        Self {
            name: case.name.clone(),
            class: String::new(),
            matter: Matter::of(case),
            digest: digest(&case.source),
        }
    }

    /// A case as it is, which a caller may have changed since it was read; for this process alone.
    pub fn given(case: &Case) -> Self {
        Self {
            matter: Arc::new(Matter::Given(Box::new(case.clone()))),
            ..Self::of(case)
        }
    }

    /// Every combination of the axes with methods and accuracies.
    pub fn tasks(
        &self,
        axes: &Axes,
        methods: &[Named],
        accuracies: &[Accuracy],
        looks: Looks,
    ) -> Vec<Task> {
        let mut tasks = Vec::new();
        for (&refine, space) in product(&axes.refine, &axes.spaces) {
            for (tip, friction) in product(&axes.tips, &axes.friction) {
                for (&increments, &cold) in product(&axes.increments, &axes.cold) {
                    for (method, accuracy) in product(methods, accuracies) {
                        let Accuracy { asked, accepted } = *accuracy;
                        let asked = Asked {
                            case: self.name.clone(),
                            digest: self.digest.clone(),
                            refine,
                            space: space.clone(),
                            tip: tip.clone(),
                            friction: friction.clone(),
                            increments,
                            cold,
                            method: method.argument.clone(),
                            tolerance: accepted,
                            finer: Some(asked).filter(|asked| *asked != accepted),
                            view: None,
                            program: method.program.clone(),
                        };
                        tasks.push(Task {
                            asked,
                            class: self.class.clone(),
                            matter: self.matter.clone(),
                            looks,
                            traction: false,
                        });
                    }
                }
            }
        }
        tasks
    }
}

impl Axes {
    /// A case as it says itself.
    pub fn of(case: &Case) -> Self {
        Self {
            refine: case.sweep.refine.clone(),
            friction: friction_values(case),
            spaces: vec![None],
            ..Self::of_file(&[])
        }
    }

    /// The problem of a file, given the friction that names it.
    pub fn of_file(friction: &[f64]) -> Self {
        Self {
            refine: vec![1],
            spaces: vec![Some(FROM_FILE.into())],
            tips: vec![None],
            friction: vec![friction.to_vec()],
            increments: vec![1],
            cold: vec![false],
        }
    }

    /// How many combinations there are.
    pub fn combinations(&self) -> usize {
        let bodies = [self.refine.len(), self.spaces.len(), self.tips.len()];
        let paths = [self.friction.len(), self.increments.len(), self.cold.len()];
        bodies
            .into_iter()
            .chain(paths)
            .fold(1, usize::saturating_mul)
    }
}

/// Methods as tasks name them.
pub fn named(choices: &[Choice]) -> Vec<Named> {
    choices.iter().map(Named::of).collect()
}

/// A contact space as tasks name it; none: the case's own.
pub fn space_name(space: Option<ContactSpace>) -> Option<String> {
    space.map(|space| space.name().to_owned())
}

/// An enrichment of tips as tasks name it; none: the case's own.
pub fn tip_name(tip: Option<Tip>) -> Option<String> {
    tip.map(name)
}

/// Friction coefficients per run and crack.
pub fn friction_values(case: &Case) -> Vec<Vec<f64>> {
    let all = |mu: &f64| vec![*mu; case.cracks.len()];
    match case.sweep.friction.as_slice() {
        [] => vec![case.cracks.iter().map(|crack| crack.friction).collect()],
        swept => swept.iter().map(all).collect(),
    }
}

/// Every entry of one list with every entry of another.
fn product<'a, A, B>(a: &'a [A], b: &'a [B]) -> impl Iterator<Item = (&'a A, &'a B)> {
    a.iter().flat_map(move |a| b.iter().map(move |b| (a, b)))
}
