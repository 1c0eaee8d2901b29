//! A contact sheet of clips: one row a clip, the same moments side by side, seen obliquely from the front.
//!
//! `cargo run --release -p kinesic-host --example contact_sheet -- OUT.png COLUMNS CLIP.bvh CLIP.bvh ...`
//!
//! Left limbs are blue, right limbs red, the rest grey; every figure stands in the middle of its cell, on the ground line.

use std::path::Path;

use image::{Rgb, RgbImage};
use kinesic_host::clip::{self, Canonical, Clip, JointMap};
use nalgebra::{UnitQuaternion, Vector3};

/// Width and height of a cell, pixels.
const CELL: (u32, u32) = (120, 170);
/// Pixels per metre.
const SCALE: f64 = 75.0;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let (Some(out), Some(Ok(columns))) = (args.first(), args.get(1).map(|c| c.parse::<u32>())) else {
        eprintln!("usage: contact_sheet OUT.png COLUMNS CLIP.bvh ...");
        std::process::exit(2);
    };
    let clips: Vec<Clip> = args[2..]
        .iter()
        .map(|path| {
            clip::read(Path::new(path)).unwrap_or_else(|error| {
                eprintln!("{error}");
                std::process::exit(1);
            })
        })
        .collect();
    let mut sheet = RgbImage::from_pixel(CELL.0 * columns, CELL.1 * clips.len() as u32, Rgb([255, 255, 255]));
    let shortest = clips.iter().map(Clip::frames).min().unwrap_or(0);
    for (row, clip) in clips.iter().enumerate() {
        for column in 0..columns {
            let frame = column as usize * shortest.saturating_sub(1) / (columns.max(2) as usize - 1);
            draw(&mut sheet, clip, frame, (column * CELL.0, row as u32 * CELL.1));
        }
    }
    if let Err(error) = sheet.save(out) {
        eprintln!("{out}: {error}");
        std::process::exit(1);
    }
}

fn draw(sheet: &mut RgbImage, clip: &Clip, frame: usize, corner: (u32, u32)) {
    let view = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.6);
    let positions = clip.positions(frame);
    let root = clip.root[frame];
    let map = JointMap::detect(&clip.skeleton);
    let at = |p: &Vector3<f64>| {
        let local = view * (p - Vector3::new(root.x, 0.0, root.z));
        let x = f64::from(corner.0) + f64::from(CELL.0) / 2.0 + SCALE * local.x;
        let y = f64::from(corner.1 + CELL.1) - 14.0 - SCALE * (local.y + 0.15 * local.z);
        (x, y)
    };
    for x in 6..CELL.0 - 6 {
        put(sheet, corner, (f64::from(corner.0 + x), f64::from(corner.1 + CELL.1 - 14)), Rgb([210, 210, 210]));
    }
    for (index, joint) in clip.skeleton.joints.iter().enumerate() {
        let side = map.as_ref().and_then(|m| m.canonical(index)).map(Canonical::name).unwrap_or_default();
        let colour = match (side.as_bytes(), joint.name.contains("Left"), joint.name.contains("Right")) {
            ([b'l', b'_', ..], ..) | (_, true, _) => Rgb([30, 90, 200]),
            ([b'r', b'_', ..], ..) | (_, _, true) => Rgb([200, 50, 40]),
            _ => Rgb([70, 70, 70]),
        };
        if let Some(parent) = joint.parent {
            line(sheet, corner, at(&positions[parent]), at(&positions[index]), colour);
        }
    }
}

fn line(sheet: &mut RgbImage, corner: (u32, u32), a: (f64, f64), b: (f64, f64), colour: Rgb<u8>) {
    let steps = (a.0 - b.0).abs().max((a.1 - b.1).abs()).ceil().max(1.0) as usize;
    for step in 0..=steps {
        let part = step as f64 / steps as f64;
        let (x, y) = (a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1));
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
            put(sheet, corner, (x + dx, y + dy), colour);
        }
    }
}

/// One pixel, if it is in the cell.
fn put(sheet: &mut RgbImage, corner: (u32, u32), at: (f64, f64), colour: Rgb<u8>) {
    let (x, y) = (at.0.floor(), at.1.floor());
    let inside = |v: f64, start: u32, size: u32| v >= f64::from(start) && v < f64::from(start + size);
    if inside(x, corner.0, CELL.0) && inside(y, corner.1, CELL.1) {
        sheet.put_pixel(x as u32, y as u32, colour);
    }
}
