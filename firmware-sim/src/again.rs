//! A sample of an earlier check, measured again: the same to the digit, or it says where not.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use kinesic_workloads::Digest;
use serde_json::Value;

use crate::check::{CheckError, Selection, check};
use crate::data::Data;
use crate::report;

/// The earlier check cannot be read.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{}: {reason}", path.display())]
#[diagnostic(help("give a file that `check --json FILE` wrote"))]
pub struct EarlierError {
    /// The file.
    path: PathBuf,
    reason: String,
}

/// What a second run of a sample gave.
#[derive(Clone, Debug)]
pub struct Again {
    /// Pairs of target and workload in the sample, and in the earlier check.
    pub counts: [usize; 2],
    /// Every pair that measured otherwise, one sentence each.
    pub failures: Vec<String>,
}

impl std::fmt::Display for Again {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [sample, all] = self.counts;
        let same = sample - self.failures.len();
        write!(f, "A second run of {sample} of {all} images: {same} measured the same, to the digit.")
    }
}

/// Measures one target of every workload in `earlier` again. `seed` decides which target.
pub fn again(data: &Data, earlier: &Path, seed: &str, progress: &(dyn Fn(&str) + Sync)) -> miette::Result<Again> {
    let refuse = |reason: String| EarlierError { path: earlier.to_owned(), reason };
    let text = std::fs::read_to_string(earlier).map_err(|error| refuse(error.to_string()))?;
    let before: Value = serde_json::from_str(&text).map_err(|error| refuse(error.to_string()))?;
    let before = results(&before).ok_or_else(|| refuse("it has no results".to_owned()))?;
    let mut sample: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (workload, target) in choose(before.keys(), seed) {
        sample.entry(target.to_owned()).or_default().push(workload.to_owned());
    }
    let mut again = Again { counts: [0, before.len()], failures: Vec::new() };
    for (target, workloads) in sample {
        let after = measure(data, Selection { targets: vec![target], workloads }, progress)?;
        for (pair, after) in after {
            again.counts[0] += 1;
            let first = &before[&pair];
            if *first != after {
                let (workload, target) = pair;
                again.failures.push(format!("{target}, {workload}: a second run differs: {first}, then {after}"));
            }
        }
    }
    Ok(again)
}

type Results = BTreeMap<(String, String), Value>;

fn measure(data: &Data, selection: Selection, progress: &(dyn Fn(&str) + Sync)) -> Result<Results, CheckError> {
    // Through text, as the earlier ones: serde_json's reading of a number may differ from it in the last digit.
    let text = report::json(data, &check(data, &selection, progress)?).to_string();
    Ok(serde_json::from_str(&text).ok().as_ref().and_then(results).expect("a check has results"))
}

/// The results by workload and target; `None` where there are none.
fn results(json: &Value) -> Option<Results> {
    let name = |one: &Value, key: &str| one[key].as_str().map(str::to_owned);
    let pair = |one: &Value| Some(((name(one, "workload")?, name(one, "target")?), one.clone()));
    let all: Option<Results> = json["results"].as_array()?.iter().map(pair).collect();
    all.filter(|all| !all.is_empty())
}

/// One target of each workload.
fn choose<'a>(pairs: impl Iterator<Item = &'a (String, String)>, seed: &str) -> Vec<(&'a str, &'a str)> {
    let mut targets: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (workload, target) in pairs {
        targets.entry(workload).or_default().push(target);
    }
    let one = |(workload, targets): (&'a str, Vec<&'a str>)| {
        let mut digest = Digest::default();
        seed.bytes().chain(workload.bytes()).for_each(|byte| digest.word(u32::from(byte)));
        (workload, targets[(digest.value() % targets.len() as u64) as usize])
    };
    targets.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_workload_is_in_the_sample_once_and_the_seed_moves_the_target() {
        let names: Vec<(String, String)> = ["a", "b", "c"]
            .iter()
            .flat_map(|workload| ["x", "y", "z"].map(|target| ((*workload).to_owned(), target.to_owned())))
            .collect();
        let drawn: Vec<_> = (0..20).map(|seed| choose(names.iter(), &seed.to_string())).collect();
        for sample in &drawn {
            assert_eq!(sample.iter().map(|(workload, _)| *workload).collect::<Vec<_>>(), ["a", "b", "c"]);
        }
        assert_eq!(choose(names.iter(), "7"), drawn[7]);
        for workload in 0..3 {
            let mut targets: Vec<_> = drawn.iter().map(|sample| sample[workload].1).collect();
            targets.sort_unstable();
            targets.dedup();
            assert_eq!(targets, ["x", "y", "z"]);
        }
    }
}
