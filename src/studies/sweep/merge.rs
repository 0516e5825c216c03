//! One folder of records from several, as shards of a sweep leave them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::record::{Origin, Record};
use super::store::{Store, StoreError};

/// What came of a merge.
#[derive(Debug)]
pub struct Merged {
    /// The folder with all records.
    pub store: Store,
    /// The records, in the order of the sweep.
    pub records: Vec<Record>,
    /// Ids of cells that no folder holds.
    pub missing: Vec<String>,
}

/// Copies the records of some folders into one. All must be of one sweep, and unless `forced` of one program and machine;
/// a cell that several folders hold must have the same numbers in all. Of two times of a cell the first is kept.
///
/// # Errors
/// Folders that cannot be read or written, other schemas and sweeps, and without `forced` other origins and
/// contradictions.
pub fn merge(from: &[PathBuf], into: &Path, forced: bool) -> Result<Merged, StoreError> {
    const REMEDY: &str = "--force merges them all the same";
    let mut stores = from
        .iter()
        .map(|dir| Store::open(dir))
        .collect::<Result<Vec<_>, _>>()?;
    let Some(contents) = stores.first().map(|first| first.contents().clone()) else {
        let dir = into.to_path_buf();
        return Err(StoreError::NoSweep { dir });
    };
    // What the target holds already is part of what is merged, whatever its list says; what is no record there is refused.
    stores.push(match Store::open(into) {
        Ok(store) if !forced || store.contents() == &contents => store,
        Ok(_) | Err(StoreError::NoSweep { .. }) => Store::at(into, contents.clone()),
        Err(error) => return Err(error),
    });
    let mut chosen: BTreeMap<String, (Record, &Store)> = BTreeMap::new();
    let mut origin: Option<Origin> = None;
    for store in &stores {
        for record in store.records()? {
            let origin = origin.get_or_insert_with(|| record.origin.clone());
            if !forced {
                store.check_origin(&record, origin, REMEDY)?;
            }
            match chosen.get(&record.id) {
                // What a limit ended says nothing about the cell.
                Some((first, _)) if first.limits.is_some() => {
                    chosen.insert(record.id.clone(), (record, store));
                }
                Some(_) if record.limits.is_some() => {}
                Some((first, other)) if !first.found.same_bits(&record.found) && !forced => {
                    return Err(StoreError::Contradiction {
                        id: record.id,
                        first: other.dir().to_path_buf(),
                        second: store.dir().to_path_buf(),
                    });
                }
                Some((first, _))
                    if !first.found.same_bits(&record.found) || first.spent.is_some() => {}
                _ => {
                    chosen.insert(record.id.clone(), (record, store));
                }
            }
        }
    }
    // Every folder names the whole sweep, also the cells of the other shards.
    for store in &stores {
        if store.contents() != &contents {
            return Err(stores[0].other(store));
        }
    }
    let store = Store::create(into, contents, forced)?;
    for (record, _) in chosen.values() {
        store.put(record)?;
    }
    let records = store.records()?;
    let ids = store.contents().cells.iter();
    let missing = ids.filter(|id| !chosen.contains_key(*id)).cloned();
    Ok(Merged {
        missing: missing.collect(),
        records,
        store,
    })
}
