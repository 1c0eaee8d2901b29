//! Frames that recorders lost, and joints that leap for one frame: named, left out of bones, bridged when asked.

use kinesic_host::clip::bvh::parse;
use kinesic_host::clip::{Clip, ReadOptions, Unit, WriteOptions};
use kinesic_host::gait::{Manner, walk};

/// What recorders write for a number that they do not have.
const LOST: f64 = 9_999_999.0;

/// The lines of numbers of a walk, and what stands before them.
fn table() -> (String, Vec<Vec<f64>>) {
    let clip = walk(&Manner::NEUTRAL, 1.0, 60.0, 0.0, 1);
    let text = clip.to_bvh(&WriteOptions { units: Unit::Centimetre }).expect("writable");
    let head = text.find("Frame Time").and_then(|at| text[at..].find('\n').map(|end| at + end + 1)).expect("a motion");
    let row = |line: &str| line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    (text[..head].to_owned(), text[head..].lines().map(row).collect())
}

fn text(head: &str, rows: &[Vec<f64>]) -> String {
    let line = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n";
    head.to_owned() + &rows.iter().map(line).collect::<String>()
}

fn read(text: &str, repair: bool) -> Clip {
    parse(text.as_bytes(), &ReadOptions { repair, ..Default::default() }).unwrap_or_else(|e| panic!("{e}"))
}

fn apart(a: &Clip, b: &Clip) -> f64 {
    assert_eq!(a.frames(), b.frames());
    a.all_positions().iter().zip(b.all_positions()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// A walk in which something was broken: what is said of it, and how far from the sound walk it is once repaired, m.
fn broken(change: impl Fn(&mut Vec<Vec<f64>>)) -> (String, f64) {
    let (head, sound) = table();
    let mut rows = sound.clone();
    change(&mut rows);
    let file = text(&head, &rows);
    let mended = read(&file, true);
    (read(&file, false).notes.join("\n"), apart(&mended, &read(&text(&head, &sound), false)))
}

#[test]
fn whole_rows_that_were_lost_are_bridged_with_their_poses() {
    for value in [LOST, 0.0] {
        let (notes, off) = broken(|rows| rows[20..25].iter_mut().for_each(|row| row.fill(value)));
        assert!(notes.contains("In frame 21, 22, 23, 24, 25 the root leaps"), "{value}: {notes}");
        assert!(off < 0.05, "{value}: {off}");
    }
    // At the ends of a recording no frame comes back: the nearest pose stands in.
    let (notes, off) = broken(|rows| rows[..2].iter_mut().for_each(|row| row.fill(LOST)));
    assert!(notes.contains("In frame 1, 2 the root leaps") && off < 0.3, "{off}: {notes}");
    let (notes, off) = broken(|rows| rows[..].iter_mut().rev().take(3).for_each(|row| row.fill(LOST)));
    assert!(notes.contains("the root leaps") && !notes.contains("jumps") && off < 0.3, "{off}: {notes}");
}

#[test]
fn a_pose_that_goes_on_is_kept_where_the_root_alone_was_lost() {
    let (head, sound) = table();
    let mut rows = sound.clone();
    rows[20..24].iter_mut().for_each(|row| row[1] += 300.0);
    let mended = read(&text(&head, &rows), true);
    let plain = read(&text(&head, &sound), false);
    assert_eq!(mended.rotations, plain.rotations);
    assert!(apart(&mended, &plain) < 0.02);
}

#[test]
fn a_limb_that_would_be_faster_than_any_is_named() {
    let (head, _) = table();
    let knee = read(&text(&head, &table().1), false).skeleton.find("LeftLeg").expect("a knee");
    // 40 degrees there and back move a shin of 0.4 m at 17 m/s; 12 degrees are a shake.
    let (notes, off) = broken(|rows| rows[20][3 + 3 * knee] += 40.0);
    assert!(notes.contains("and back ('LeftLeg' in frame 21)") && off < 0.03, "{off}: {notes}");
    let (notes, _) = broken(|rows| rows[20][3 + 3 * knee] += 12.0);
    assert!(!notes.contains("and back"), "{notes}");
}

/// The walk with position channels on all joints that hold `place` of the joint's OFFSET.
fn six(place: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> (String, Vec<Vec<f64>>) {
    let (head, rows) = table();
    let clip = read(&text(&head, &rows), false);
    let head = head.replace("CHANNELS 3 ", "CHANNELS 6 Xposition Yposition Zposition ");
    let offsets: Vec<[f64; 3]> = clip.skeleton.joints.iter().map(|j| (j.offset * 100.0).into()).collect();
    let six = |row: &Vec<f64>| {
        let joints = row[3..].chunks_exact(3).enumerate();
        joints
            .flat_map(|(j, turn)| if j == 0 { row[..6].to_vec() } else { [&place(j, offsets[j]), turn].concat() })
            .collect()
    };
    (head, rows.iter().map(six).collect())
}

#[test]
fn no_bone_is_measured_by_a_lost_frame() {
    let (head, sound) = six(|_, offset| offset);
    let plain = read(&text(&head, &sound), false);
    for value in [LOST, 0.0] {
        let mut rows = sound.clone();
        rows[20].fill(value);
        let clip = read(&text(&head, &rows), false);
        assert!(clip.notes.iter().any(|n| n.contains("In frame 21 position channels")), "{value}: {:?}", clip.notes);
        let off = clip.skeleton.joints.iter().zip(&plain.skeleton.joints).map(|(a, b)| (a.offset - b.offset).norm());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{value}");
        assert!(apart(&read(&text(&head, &rows), true), &plain) < 0.02, "{value}");
    }
}

#[test]
fn positions_that_are_mostly_0_are_added_to_the_offsets() {
    let plain = read(&text(&table().0, &table().1), false);
    let (head, rows) = six(|joint, _| if joint == 5 { [0.5, 0.0, 0.0] } else { [0.0; 3] });
    let clip = read(&text(&head, &rows), false);
    assert!(clip.notes.iter().any(|n| n.contains("added to the OFFSETs")), "{:?}", clip.notes);
    let off = (clip.skeleton.joints[5].offset - plain.skeleton.joints[5].offset).norm();
    assert!((off - 0.005).abs() < 1e-6 && apart(&clip, &plain) < 0.006, "{off}");
}
