//! Whether a training has learned anything: a pack that cannot be of use is refused.

use miette::miette;

/// How far apart two motions are, cm and degrees.
pub type Apart = [f64; 2];

/// Distances under which two motions are the same.
const NOTHING: Apart = [0.01, 0.05];

/// The option that every training has.
#[derive(Debug, clap::Args)]
pub struct Forced {
    /// Write the pack even if it learned nothing, or is worse than doing nothing
    #[arg(long)]
    force: bool,
}

impl Forced {
    /// Refuses a pack for the reason that there is, if any; forced, the reason is a note.
    pub fn check(&self, why: Option<String>, help: &str) -> miette::Result<()> {
        let Some(why) = why else { return Ok(()) };
        if self.force {
            eprintln!("note: {why}");
            return Ok(());
        }
        Err(miette!(help = format!("{help}; --force writes the pack all the same"), "{why}"))
    }
}

/// Whether two motions are one.
pub fn same([cm, degrees]: Apart) -> bool {
    cm < NOTHING[0] && degrees < NOTHING[1]
}

/// Says that `what` comes no nearer than doing nothing, if so in both measures.
pub fn no_nearer(what: &str, before: Apart, after: Apart) -> Option<String> {
    // A distance that is no number is none that was brought down.
    let nearer = before.iter().zip(after).any(|(before, after)| after < *before);
    (!nearer).then(|| {
        let ([cm_before, before], [cm, degrees]) = (before, after);
        format!(
            "{what} than doing nothing: {cm:.2} against {cm_before:.2} cm, {degrees:.2} against {before:.2} degrees"
        )
    })
}

/// Says that an order is not found, if no more pairs are right than by chance.
pub fn by_chance(what: &str, accuracy: f64) -> Option<String> {
    let found = accuracy > 0.5;
    (!found).then(|| match accuracy.is_finite() {
        true => format!("{what}: {:.0} % of its pairs are in the right order, and chance finds 50 %", 100.0 * accuracy),
        false => format!("{what}: no two of them have different labels"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_measure_that_falls_is_enough_and_no_number_is_no_gain() {
        assert!(same([0.001, 0.01]) && !same([0.001, 0.1]));
        assert_eq!(no_nearer("the pack comes no nearer", [5.0, 4.0], [6.0, 3.0]), None);
        let why = no_nearer("the pack comes no nearer", [5.0, 4.0], [5.0, 4.0]).unwrap();
        assert!(why.contains("no nearer than doing nothing: 5.00 against 5.00 cm, 4.00 against 4.00 degrees"), "{why}");
        assert!(no_nearer("it", [5.0, 4.0], [f64::NAN, f64::NAN]).is_some());
        assert_eq!(by_chance("smile", 0.51), None);
        assert!(by_chance("smile", 0.5).unwrap().contains("smile: 50 % of its pairs"));
        assert!(by_chance("smile", f64::NAN).unwrap().contains("no two of them"));
    }
}
