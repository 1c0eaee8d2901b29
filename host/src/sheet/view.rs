//! From where figures are seen.

use nalgebra::{UnitQuaternion, Vector3};

/// A direction of view. Figures face +Z.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// From the front and a little from the side and from above.
    #[default]
    Oblique,
    /// From the front.
    Front,
    /// From the right: what walks goes to the right of the picture.
    Side,
    /// From above: what walks goes down the picture.
    Top,
}

/// How far to the side the oblique view stands, rad.
const ASIDE: f64 = 0.6;
/// How much lower in the picture a metre nearer to the viewer is in the oblique view, m.
const ABOVE: f64 = 0.15;

impl View {
    /// Right, up and towards the viewer, m.
    pub fn project(self, point: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Front => *point,
            Self::Side => Vector3::new(point.z, point.y, -point.x),
            Self::Top => Vector3::new(point.x, -point.z, point.y),
            Self::Oblique => {
                let turned = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), ASIDE) * point;
                Vector3::new(turned.x, turned.y - ABOVE * turned.z, turned.z)
            }
        }
    }

    /// Whether the ground is a line.
    pub fn has_horizon(self) -> bool {
        self != Self::Top
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walks_go_to_the_right_seen_from_the_side_and_down_seen_from_above() {
        let (forward, left, up) = (Vector3::z(), Vector3::x(), Vector3::y());
        assert_eq!(View::Side.project(&forward).x, 1.0);
        // The left hand is farther away there.
        assert_eq!(View::Side.project(&left).z, -1.0);
        assert_eq!(View::Top.project(&forward).y, -1.0);
        assert_eq!(View::Front.project(&left).x, 1.0);
        for view in [View::Oblique, View::Front, View::Side] {
            assert_eq!(view.project(&up).y, 1.0);
        }
    }
}
