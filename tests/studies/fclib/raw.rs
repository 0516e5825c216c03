//! FCLIB files put together dataset by dataset, right or wrong.

use hdf5_pure::{FileBuilder, GroupBuilder};
use stickslip::files::interchange::Problem;

use super::{W, read_bytes};

/// Contents of a test file; every test changes one thing.
pub struct Raw {
    pub integers: Vec<(&'static str, Vec<i32>)>,
    pub reals: Vec<(&'static str, Vec<f64>)>,
}

impl Raw {
    pub fn new(nz: i32, p: &[i32], i: &[i32], x: &[f64]) -> Self {
        let integer = |name, value: &[i32]| (name, value.to_vec());
        Self {
            integers: vec![
                integer("spacedim", &[2]),
                integer("W/m", &[4]),
                integer("W/n", &[4]),
                integer("W/nzmax", &[x.len() as i32]),
                integer("W/nz", &[nz]),
                integer("W/p", p),
                integer("W/i", i),
            ],
            reals: vec![
                ("W/x", x.to_vec()),
                ("vectors/q", vec![-1.0, 0.25, 0.1, -0.3]),
                ("vectors/mu", vec![0.5, 0.0]),
            ],
        }
    }

    pub fn triplets() -> Self {
        let i: Vec<i32> = W.iter().map(|e| e.0 as i32).collect();
        let p: Vec<i32> = W.iter().map(|e| e.1 as i32).collect();
        let x: Vec<f64> = W.iter().map(|e| e.2).collect();
        Self::new(10, &p, &i, &x)
    }

    pub fn columns() -> Self {
        let i: Vec<i32> = W.iter().map(|e| e.0 as i32).collect();
        let x: Vec<f64> = W.iter().map(|e| e.2).collect();
        Self::new(-1, &[0, 3, 5, 8, 10], &i, &x)
    }

    pub fn integers(mut self, name: &'static str, values: &[i32]) -> Self {
        self.integers.retain(|e| e.0 != name);
        self.integers.push((name, values.to_vec()));
        self
    }

    pub fn reals(mut self, name: &'static str, values: &[f64]) -> Self {
        self.reals.retain(|e| e.0 != name);
        self.reals.push((name, values.to_vec()));
        self
    }

    pub fn without(mut self, name: &'static str) -> Self {
        self.integers.retain(|e| e.0 != name);
        self.reals.retain(|e| e.0 != name);
        self
    }

    pub fn read(&self) -> Result<Problem, String> {
        self.read_into(FileBuilder::new())
    }

    /// As [`Self::read`], with what a file holds already.
    pub fn read_into(&self, mut file: FileBuilder) -> Result<Problem, String> {
        let root = file.create_group("fclib_local");
        self.read_within(file, root)
    }

    /// As [`Self::read_into`], with what the group of the problem holds already.
    pub fn read_within(
        &self,
        mut file: FileBuilder,
        mut root: GroupBuilder,
    ) -> Result<Problem, String> {
        for group in ["W", "V", "R", "vectors"] {
            let own = |name: &'static str| name.strip_prefix(group)?.strip_prefix('/');
            if !self.reals.iter().any(|e| own(e.0).is_some()) {
                continue;
            }
            let mut builder = root.create_group(group);
            for (name, values) in &self.integers {
                if let Some(name) = own(name) {
                    builder.create_dataset(name).with_i32_data(values);
                }
            }
            for (name, values) in &self.reals {
                if let Some(name) = own(name) {
                    builder.create_dataset(name).with_f64_data(values);
                }
            }
            root.add_group(builder.finish());
        }
        for (name, values) in self.integers.iter().filter(|e| !e.0.contains('/')) {
            root.create_dataset(name).with_i32_data(values);
        }
        for (name, values) in self.reals.iter().filter(|e| !e.0.contains('/')) {
            root.create_dataset(name).with_f64_data(values);
        }
        file.add_group(root.finish());
        read_bytes(file.finish().unwrap())
    }
}
