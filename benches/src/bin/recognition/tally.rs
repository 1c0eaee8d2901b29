//! What the classifiers said, and the angles to the targets.

use kinesic_host::measure::Degrees;
use kinesic_host::translate::{Angles, Errors};

use super::clips::STYLES;

const COUNT: usize = STYLES.len();
/// What is shown to the classifiers.
const NAMES: [&str; 4] = ["real clips, held out", "source, unchanged", "source + mean offset", "output of the pack"];
const JOINTS: [&str; 3] = ["Head", "Hand_L", "Hand_R"];

/// What is shown to the classifiers.
#[derive(Clone, Copy)]
pub enum Shown {
    Real,
    Source,
    Offset,
    Output,
}

#[derive(Default)]
pub struct Tally {
    /// By rotations and by positions; of what was shown; of the wanted style; called so.
    called: [[[[usize; COUNT]; COUNT]; NAMES.len()]; 2],
    pub angles: Vec<Errors>,
}

impl Tally {
    pub fn count(&mut self, shown: Shown, wanted: usize, said: [usize; 2]) {
        self.called.iter_mut().zip(said).for_each(|(called, said)| called[shown as usize][wanted][said] += 1);
    }

    pub fn print(&self) {
        for (called, by) in self.called.iter().zip(["rotations", "positions"]) {
            println!("\nRecognised as the wanted style by {by}, %\n");
            println!("| shown | clips | {} | **all** |", STYLES.join(" | "));
            println!("|---|---|{}---|", "---|".repeat(COUNT));
            for (called, name) in called.iter().zip(NAMES) {
                let clips: usize = called.as_flattened().iter().sum();
                let right: usize = (0..COUNT).map(|style| called[style][style]).sum();
                let share = |right: usize, all: usize| 100.0 * right as f64 / all as f64;
                print!("| {name} | {clips} |");
                for (style, row) in called.iter().enumerate() {
                    let all = row.iter().sum::<usize>();
                    if all > 0 { print!(" {:.0} |", share(row[style], all)) } else { print!(" |") }
                }
                println!(" **{:.1}** |", share(right, clips));
            }
            println!("\nOutputs (row: wanted style, column: style that {by} are taken for)\n");
            for (row, style) in called[Shown::Output as usize].iter().zip(STYLES) {
                println!("{style:10} {row:?}");
            }
        }
        self.print_angles();
    }

    fn print_angles(&self) {
        println!("\nMean angle to the target, degrees; mean of {} outputs\n", self.angles.len());
        println!("| joint | source | offset | affine | **output** |\n|---|---|---|---|---|");
        let of = |pick: fn(&Angles) -> Option<&Degrees>| {
            Degrees::mean(self.angles.iter().filter_map(|errors| pick(&errors.degrees)).collect::<Vec<_>>().into_iter())
        };
        let columns = [of(|a| Some(&a.identity)), of(|a| a.offset.as_ref()), of(|a| a.affine.as_ref()), of(|a| Some(&a.error))];
        let row = |name: &str, of: &dyn Fn(&Degrees) -> f64| {
            let [source, offset, affine, output] = columns.each_ref().map(of);
            println!("| {name} | {source:.1} | {offset:.1} | {affine:.1} | **{output:.1}** |");
        };
        for name in JOINTS {
            let angle = |d: &Degrees| d.joints.iter().find(|joint| joint.joint == name).map_or(f64::NAN, |joint| joint.angle);
            row(name, &angle);
        }
        row("leaves: head, hands, toes", &|d| d.leaves);
        row("all joints", &|d| d.all);
        let mean = |of: fn(&Errors) -> f64| self.angles.iter().map(of).sum::<f64>() / self.angles.len() as f64;
        let cm = [mean(|e| e.identity_cm), mean(|e| e.offset_cm), mean(|e| e.affine_cm), mean(|e| e.error_cm)];
        println!("\nRMS joint distance, cm: {:.2} {:.2} {:.2} {:.2}", cm[0], cm[1], cm[2], cm[3]);
    }
}
