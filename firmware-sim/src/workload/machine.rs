//! The three machines of servos that the tests learn: trained from their made moves, with hobby servos' limits, on a take that was not trained on.

// The machines of tests/tests/servos.rs.
#[path = "../../../tests/tests/common/servos.rs"]
#[allow(unreachable_pub)]
mod made;

use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::robot::{Defaults, Machine, ServoTable};
use kinesic_host::translate::{TrainOptions, TrainPair, train};
use kinesic_workloads::Workload;
use kinesic_workloads::machine::{Antennas, Head, Lamp};
use kinesic_workloads::player::Layers;

use super::{Prepared, WorkloadError, on_host};

pub fn head(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    prepare::<Head>(name, "servo-head.kin", &made::head(), frames, Defaults::default())
}

pub fn lamp(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    prepare::<Lamp>(name, "servo-lamp.kin", &made::lamp(), frames, Defaults::default())
}

pub fn antennas(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    prepare::<Antennas>(name, "servo-antennas.kin", &made::antennas(), frames, Defaults::default())
}

/// The same head with a player before the style, and jerk limits.
pub fn player(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let jerk = Defaults { jerk: Some(3000.0), ..Defaults::default() };
    prepare::<Layers>(name, "servo-player.kin", &made::antennas(), frames, jerk)
}

/// Hobby servos, one on the other.
fn table(machine: &made::Machine) -> String {
    let servo = |(id, servo): (usize, &made::Servo)| {
        format!(
            "[[servo]]\nname = {:?}\nid = {id}\nunit = \"us\"\nper_turn = 4000\nzero = 1500\nmin = 700\nmax = 2300\nspeed = 6600\nacceleration = 99000\n",
            servo.name
        )
    };
    format!("name = {:?}\n", machine.name) + &machine.servos.iter().enumerate().map(servo).collect::<String>()
}

fn prepare<W: Workload>(
    name: &str,
    pack_name: &'static str,
    machine: &made::Machine,
    frames: usize,
    defaults: Defaults,
) -> Result<Prepared, WorkloadError> {
    let robot = ServoTable::parse(&table(machine))
        .and_then(|table| Machine::of_table(&table, made::FPS, defaults))
        .expect("the table is well formed");
    let pair = |seed| {
        let [source, target] = machine.take(seed, 40.0).map(|motion| machine.locals(&robot.rig, &motion));
        TrainPair { source_name: "calm".into(), target_name: "lively".into(), source, target }
    };
    let trained = train(&robot.rig, &[pair(1), pair(2)], "lively", made::FPS, &TrainOptions::default(), &|_| {})?;
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), ..Provenance::default() };
    let style = PackFile::from_bytes(&trained.model.pack(&robot.rig, &provenance));
    let pack = robot.pack(Some(&style.pack()?), &provenance)?;
    let [calm, _] = machine.take(77, frames as f64 / made::FPS);
    let angles: Vec<Vec<f32>> = calm.iter().map(|row| row.iter().map(|x| *x as f32).collect()).collect();
    on_host::<W>(name, pack_name, pack, &angles)
}
