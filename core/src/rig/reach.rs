//! How far a body may be carried from where its source stands.

use crate::kernel::sqrt;
use crate::pose::FARTHEST;

/// How far a body is carried from where its source stands unless something else is asked for, m.
pub const REACH: f32 = 4.0;

/// Part of the reach that is felt by nothing.
const FREE: f32 = 0.5;

/// A length that rounding does not take beyond the reach, in reaches.
const NEARLY: f32 = 0.999_999;

/// `at` moved by `by`, m. What takes it farther out counts in full up to half the reach, then ever less, and nothing at the reach; what
/// brings it back counts in full. No sequence of moves from within the reach leads beyond it. A place beyond it gets no farther out.
///
/// A reach of a thousand kilometres and more is none; one that is negative or NaN counts as 0. Cost: 8 multiply-adds; beyond half the reach
/// two roots and two divisions more.
pub(crate) fn carried([x, z]: [f32; 2], [by_x, by_z]: [f32; 2], reach: f32) -> [f32; 2] {
    let [to_x, to_z] = [x + by_x, z + by_z];
    // Of a NaN and a number this is the number.
    let reach = reach.max(0.0);
    let free = FREE * reach;
    let far = to_x * to_x + to_z * to_z;
    let was = x * x + z * z;
    if reach >= FARTHEST || far <= free * free || far <= was {
        return [to_x, to_z];
    }
    let (far, was) = (sqrt(far), sqrt(was));
    let part = if was > free { (was - free) / (reach - free) } else { 0.0 };
    let room = (NEARLY * reach - was).max(0.0);
    let length = was + ((far - was) * (1.0 - part * part)).max(0.0).min(room);
    let share = (length / far).min(1.0);
    [to_x * share, to_z * share]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn far([x, z]: [f32; 2]) -> f64 {
        f64::from(x).hypot(f64::from(z))
    }

    #[test]
    fn near_the_middle_it_is_a_sum_and_without_a_reach_always() {
        let (mut at, mut sum) = ([0.0; 2], [0.0f32; 2]);
        for step in 0..100 {
            let by = [0.01 * libm::sinf(step as f32), 0.009];
            (at, sum) = (carried(at, by, 2.0), [sum[0] + by[0], sum[1] + by[1]]);
            assert_eq!(at, sum);
        }
        assert_eq!(carried([7.0, 1.0], [0.5, 0.5], f32::INFINITY), [7.5, 1.5]);
    }

    #[test]
    fn a_straight_way_out_comes_to_the_reach_smoothly_and_leads_back_at_once() {
        let (mut at, mut last) = ([0.0; 2], 0.01f32);
        for _ in 0..10_000 {
            let to = carried(at, [0.008, 0.006], 2.0);
            let step = far(to) as f32 - far(at) as f32;
            assert!((-1e-6..last + 1e-6).contains(&step) && last - step < 2e-4, "{step} after {last}");
            (at, last) = (to, step);
        }
        assert!((1.99..=2.0).contains(&far(at)), "{at:?}");
        let back = carried(at, [-0.008, -0.006], 2.0);
        assert!((far(at) - far(back) - 0.01).abs() < 1e-6);
        // Where nothing moves nothing creeps.
        assert_eq!(carried(at, [0.0; 2], 2.0), at);
    }

    #[test]
    fn what_stands_beyond_comes_back_and_gets_no_farther() {
        assert_eq!(carried([-100.0, 0.0], [1.0, 0.0], 2.0), [-99.0, 0.0]);
        assert!(far(carried([-100.0, 0.0], [-1.0, 1.0], 2.0)) <= 100.0 * 1.000_001);
        assert_eq!(carried([0.0; 2], [1.0, -1.0], 0.0), [0.0; 2]);
        for reach in [f32::NAN, -1.0, f32::NEG_INFINITY] {
            assert_eq!(carried([0.0; 2], [1.0, -1.0], reach), [0.0; 2]);
        }
    }
}
