//! What the classifiers said, and the angles to the targets.

use kinesic_host::measure::Degrees;
use kinesic_host::translate::{Angles, Errors};

use super::clips::STYLES;

const COUNT: usize = STYLES.len();
/// What is shown to the classifiers.
const NAMES: [&str; 5] = [
    "real clips, held out",
    "source, unchanged",
    "source + mean offset",
    "output of the pack",
    "the same, by a classifier that saw the other takes",
];
/// What it is judged by.
pub const KINDS: [&str; 3] = ["rotations", "the deviations of rotations alone", "positions"];
pub const SEEN: usize = KINDS.len();
const JOINTS: [&str; 3] = ["Head", "Hand_L", "Hand_R"];

/// What is shown to the classifiers.
#[derive(Clone, Copy)]
pub enum Shown {
    Real,
    Source,
    Offset,
    Output,
    /// To a classifier that saw the takes that judge, none that the pack has seen.
    ToStrangers,
}

#[derive(Default)]
pub struct Tally {
    /// By kind of features; of what was shown; of the wanted style; called so.
    called: [[[[usize; COUNT]; COUNT]; NAMES.len()]; SEEN],
    /// What was done, and how far from the target it came out.
    pub errors: Vec<(&'static str, Errors)>,
    pub images: Vec<(&'static str, Errors)>,
    /// Sums of squared deviations of rotations by style: of targets, of outputs.
    spread: [[f64; 2]; COUNT],
}

impl Tally {
    pub fn count(&mut self, shown: Shown, wanted: usize, said: [usize; SEEN]) {
        self.called.iter_mut().zip(said).for_each(|(called, said)| called[shown as usize][wanted][said] += 1);
    }

    /// Deviations of the rotations of a target and of an output.
    pub fn spread(&mut self, style: usize, deviations: [Vec<f64>; 2]) {
        let squares = |deviations: &Vec<f64>| deviations.iter().map(|x| x * x).sum::<f64>();
        self.spread[style].iter_mut().zip(&deviations).for_each(|(sum, deviations)| *sum += squares(deviations));
    }

    pub fn print(&self) {
        for (called, by) in self.called.iter().zip(KINDS) {
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
        }
        println!("\nRMS deviation of the rotations of the outputs, % of that of their targets\n");
        println!("| {} |\n|{}", STYLES[1..].join(" | "), "---|".repeat(COUNT - 1));
        let share = |[target, output]: &[f64; 2]| format!(" {:.0} |", 100.0 * (output / target).sqrt());
        println!("|{}", self.spread[1..].iter().map(share).collect::<String>());
        self.print_angles();
        self.print_distances();
    }

    /// Open ends: a take may begin on the other foot.
    fn print_distances(&self) {
        print_errors("Aligned RMS joint distance to the target, cm, open ends", &self.errors);
        print_errors("The same of the mirror images of these takes", &self.images);
    }
    fn print_angles(&self) {
        println!("\nMean angle to the target, degrees; mean of {} outputs\n", self.errors.len());
        println!("| joint | source | offset | affine | **output** |\n|---|---|---|---|---|");
        let of = |pick: fn(&Angles) -> Option<&Degrees>| {
            Degrees::mean(
                self.errors.iter().filter_map(|(_, errors)| pick(&errors.degrees)).collect::<Vec<_>>().into_iter(),
            )
        };
        let columns =
            [of(|a| Some(&a.identity)), of(|a| a.offset.as_ref()), of(|a| a.affine.as_ref()), of(|a| Some(&a.error))];
        let row = |name: &str, of: &dyn Fn(&Degrees) -> f64| {
            let [source, offset, affine, output] = columns.each_ref().map(of);
            println!("| {name} | {source:.1} | {offset:.1} | {affine:.1} | **{output:.1}** |");
        };
        for name in JOINTS {
            let angle =
                |d: &Degrees| d.joints.iter().find(|joint| joint.joint == name).map_or(f64::NAN, |joint| joint.angle);
            row(name, &angle);
        }
        row("leaves: head, hands, toes", &|d| d.leaves);
        row("all joints", &|d| d.all);
    }
}

fn print_errors(title: &str, errors: &[(&str, Errors)]) {
    println!("\n{title}\n");
    println!("| action | outputs | source | offset | affine | **output** |\n|---|---|---|---|---|---|");
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in errors {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let row = |name: &str, errors: Vec<&Errors>| {
        let mean = |of: fn(&Errors) -> f64| errors.iter().map(|e| of(e)).sum::<f64>() / errors.len() as f64;
        let [source, offset, affine, output] = [
            mean(|e| e.open_identity_cm),
            mean(|e| e.open_offset_cm),
            mean(|e| e.open_affine_cm),
            mean(|e| e.open_error_cm),
        ];
        let count = errors.len();
        println!("| {name} | {count} | {source:.2} | {offset:.2} | {affine:.2} | **{output:.2}** |");
    };
    for name in &names {
        row(name, errors.iter().filter(|(of, _)| *of == *name).map(|(_, errors)| errors).collect());
    }
    row("all", errors.iter().map(|(_, errors)| errors).collect());
}
