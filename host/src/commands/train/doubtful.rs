//! Pairs whose clips do not seem to show the same action.

use kinesic_host::quality::Quality;
use kinesic_host::translate::{Alignment, PairReport};

/// So many times as far apart as the clips of the pair in the middle is doubtful.
const FAR: f64 = 2.5;
/// Nearer than this, cm, no pair is.
const NEAR: f64 = 5.0;
/// Pairs that there must be for a middle to mean something.
const PAIRS: usize = 3;
/// Steps a minute of who walks, and of who does not.
const STEPS: [f64; 2] = [40.0, 10.0];

/// What speaks against pairs, one sentence each.
pub fn doubtful(pairs: &[PairReport], alignment: Alignment) -> Vec<String> {
    let apart = |pair: &PairReport| pair.errors.judged(alignment).identity_cm;
    let mut sorted: Vec<f64> = pairs.iter().map(apart).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let far = |pair: &PairReport| {
        let cm = apart(pair);
        (pairs.len() >= PAIRS && cm > (FAR * middle).max(NEAR))
            .then(|| format!("its clips are {cm:.1} cm apart, those of the pair in the middle {middle:.1} cm"))
    };
    let walks = |pair: &PairReport| {
        let [a, b] = pair.quality.as_ref().map(|q| [q.source, q.target])?.map(|q: Quality| q.steps_a_minute);
        let one = a.max(b) >= STEPS[0] && a.min(b) <= STEPS[1];
        one.then(|| format!("one steps {a:.0} times a minute, the other {b:.0}"))
    };
    let note = |pair: &PairReport| {
        let why = far(pair).or_else(|| walks(pair))?;
        Some(format!("{} -> {}: {why}: do they show the same action?", pair.source, pair.target))
    };
    pairs.iter().filter_map(note).collect()
}

#[cfg(test)]
mod tests {
    use kinesic_host::quality::Compared;
    use kinesic_host::translate::Errors;

    use super::*;

    fn pair(name: &str, cm: f64, steps: [f64; 2]) -> PairReport {
        let quality = |steps_a_minute| Quality { steps_a_minute, ..Quality::default() };
        let [source, target] = steps.map(quality);
        PairReport {
            source: name.to_owned(),
            target: "styled".to_owned(),
            errors: Errors { identity_cm: cm, ..Errors::default() },
            quality: Some(Compared {
                source,
                target,
                result: source,
                source_posture_degrees: 0.0,
                result_posture_degrees: 0.0,
            }),
        }
    }

    #[test]
    fn the_pair_that_differs_is_named() {
        let alike = |name: &str| pair(name, 12.0, [100.0, 90.0]);
        let pairs = [alike("a"), alike("b"), pair("jump", 40.0, [100.0, 90.0]), pair("bow", 14.0, [100.0, 0.0])];
        let notes = doubtful(&pairs, Alignment::Warp);
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(notes[0].contains("jump -> styled: its clips are 40.0 cm apart"), "{notes:?}");
        assert!(notes[1].contains("bow -> styled: one steps 100 times a minute, the other 0"), "{notes:?}");
        assert!(doubtful(&[alike("a"), pair("far", 90.0, [0.0, 0.0])], Alignment::Warp).is_empty());
    }
}
