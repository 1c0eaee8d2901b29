//! Where the joints of a robot are while it moves.

use super::Machine;
use super::look::Look;
use crate::clip::Clip;
use crate::clip::positions::table;

impl Machine {
    /// The table of [`Clip::to_positions`] for a motion of this robot, sliders included: it stands on the ground and faces +Z, as it is drawn.
    pub fn positions(&self, clip: &Clip) -> String {
        let look = Look::of_machine(self);
        let frame = |frame: usize| {
            let placed = look.placed(clip.coordinates(frame).unwrap_or(&[]));
            look.joints.iter().map(|link| placed[*link].translation.vector).collect()
        };
        table(&self.rig.skeleton, clip.frame_time, (0..clip.frames()).map(frame))
    }
}

#[cfg(test)]
mod tests {
    use crate::rig::frame_of;
    use crate::robot::{Defaults, Machine, ServoTable};

    #[test]
    fn a_slider_carries_what_is_on_it() {
        let table = "[[servo]]\nname = \"lift\"\nunit = \"mm\"\nmin = 0\nmax = 80\n[[servo]]\nname = \"tilt\"\nparent = \"lift\"\nunit = \"deg\"\nmin = -90\nmax = 90\naxis = [0, 1, 0]\n";
        let machine = Machine::of_table(&ServoTable::parse(table).unwrap(), 50.0, Defaults::default()).unwrap();
        let frames: Vec<_> = (0..3).map(|at| frame_of(&[0.01 * f64::from(at), 0.0, 0.0])).collect();
        let text = machine.positions(&machine.rig.clip_of(&frames, 0.02));
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let column = reader.headers().unwrap().iter().position(|name| name == "tilt.y").unwrap();
        let heights: Vec<f64> = reader.records().map(|row| row.unwrap()[column].parse().unwrap()).collect();
        assert!((heights[2] - heights[0] - 0.02).abs() < 1e-5, "{heights:?}");
    }
}
