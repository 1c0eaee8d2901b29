//! A face pack on a picture: landmarks for the page's core, and the picture's warps.

use std::io::Cursor;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use image::{DynamicImage, ImageError};
use kinesic::Pack;
use kinesic::face::{FaceFrame, Landmarks};
use serde::Serialize;

use super::{ViewError, ViewPack};
use crate::face::warp::Warp;
use crate::face::{Edit, HostFace, Wish, edit};

/// Longest side of a picture on the page, pixels.
const SIDE: u32 = 800;
/// Quality of the page's JPEG, of 100.
const QUALITY: u8 = 92;
/// Warps on each side of the picture as it is.
const STEPS: usize = 12;
/// Cells of a warp in the face's unit.
const CELLS: f64 = 24.0;
/// Parts of a pixel in which a displacement is written.
const PARTS: f64 = 32.0;

/// A picture of a face to show.
#[derive(Clone, Debug)]
pub struct ViewFace {
    /// What it is called on the page.
    pub name: String,
    /// The picture.
    pub picture: DynamicImage,
    /// The face's landmarks, in pixels of the picture.
    pub landmarks: Landmarks,
}

/// A face pack as the scripts read it.
#[derive(Serialize)]
pub(super) struct FacePackData {
    name: String,
    attribute: String,
    plausible: [f32; 2],
    size: usize,
    bytes: String,
}

/// A picture as the scripts read it.
#[derive(Serialize)]
pub(super) struct FaceData {
    name: String,
    jpeg: String,
    landmarks: String,
    /// Pixels of the page's picture to one of the landmarks'.
    scale: f64,
}

/// A pack on a picture.
#[derive(Serialize)]
pub(super) struct FaceSceneData {
    /// Changes of strength at which the host has warped the picture, ascending; 0 is one of them.
    changes: Vec<f64>,
    /// Of the landmarks at all changes, one after the other.
    digest: String,
    /// Place of the warps' first node, their spacing, pixels of the page's picture.
    origin: [f64; 2],
    cell: f64,
    columns: usize,
    /// Parts of a pixel in which displacements are written.
    parts: f64,
    /// Where the page's pixel comes from, less its place: 16-bit integers `x, y` by rows, a change.
    warps: Vec<String>,
    /// Pixels of the page's picture by which the mean of two warps is off from the exact one halfway between them, where anything
    /// moves: mean and largest.
    between: [f64; 2],
}

/// Plays one face pack.
pub(super) struct FacePlayer<'p> {
    name: &'p str,
    pack: Pack<'p>,
    bytes: &'p [u8],
}

impl<'p> FacePlayer<'p> {
    pub fn new(of: &'p ViewPack) -> Result<Self, ViewError> {
        let refuse = |error| ViewError::Pack { name: of.name.clone(), error };
        let pack = of.file.pack().map_err(refuse)?;
        HostFace::load(&pack).map_err(refuse)?;
        Ok(Self { name: &of.name, pack, bytes: of.file.bytes() })
    }

    pub fn data(&self) -> Result<FacePackData, ViewError> {
        let model = self.model()?;
        Ok(FacePackData {
            name: self.name.to_owned(),
            attribute: model.meta().attribute.to_owned(),
            plausible: model.meta().strength,
            size: self.bytes.len(),
            bytes: BASE64_STANDARD.encode(self.bytes),
        })
    }

    fn model(&self) -> Result<HostFace<'_>, ViewError> {
        HostFace::load(&self.pack).map_err(|error| ViewError::Pack { name: self.name.to_owned(), error })
    }

    /// The picture with less and more of the expression.
    pub fn scene(&self, face: &ViewFace) -> Result<FaceSceneData, ViewError> {
        let not_one = || ViewError::Face { name: face.name.clone() };
        let read = self.model()?.read(&face.landmarks).ok_or_else(not_one)?;
        let changes = changes(read.strength, self.model()?.meta().strength);
        let edited = |change: f32| -> Result<(Edit, Warp), ViewError> {
            let edited = edit(&self.pack, &face.landmarks, Wish::Change(change));
            let edited = edited.map_err(|error| ViewError::Pack { name: self.name.to_owned(), error })?;
            let edited = edited.ok_or_else(not_one)?;
            let warp = Warp::new(&face.landmarks, &edited.offsets)
                .map_err(|error| ViewError::Warp { name: face.name.clone(), error })?;
            Ok((edited, warp))
        };
        let exact = changes.iter().map(|change| edited(*change)).collect::<Result<Vec<_>, _>>()?;
        let halfway = changes.windows(2).map(|pair| edited(pair[0].midpoint(pair[1])).map(|(_, warp)| warp));
        let halfway = halfway.collect::<Result<Vec<_>, _>>()?;
        let unit = f64::from(FaceFrame::of(&face.landmarks).ok_or_else(not_one)?.scale());
        let nodes = Nodes::new(scale(face), unit, exact.iter().map(|(_, warp)| warp));
        let words = exact.iter().flat_map(|(edited, _)| edited.landmarks.as_flattened()).map(|x| x.to_bits());
        let warps: Vec<Vec<[i16; 2]>> = exact.iter().map(|(_, warp)| nodes.read(warp)).collect();
        Ok(FaceSceneData {
            changes: changes.iter().map(|change| f64::from(*change)).collect(),
            digest: super::hash(words),
            origin: nodes.origin,
            cell: nodes.cell,
            columns: nodes.columns,
            parts: PARTS,
            between: mean_and_most(warps.windows(2).zip(&halfway).flat_map(|(pair, exact)| nodes.between(pair, exact))),
            warps: warps.iter().map(|warp| BASE64_STANDARD.encode(bytemuck::cast_slice(warp))).collect(),
        })
    }
}

/// The picture as the page has it.
pub(super) fn data(face: &ViewFace) -> Result<FaceData, ViewError> {
    let small = match scale(face) < 1.0 {
        true => face.picture.resize(SIDE, SIDE, FilterType::CatmullRom),
        false => face.picture.clone(),
    };
    let mut jpeg = Cursor::new(Vec::new());
    let refuse = |error: ImageError| ViewError::Picture { name: face.name.clone(), error: error.to_string() };
    small.to_rgb8().write_with_encoder(JpegEncoder::new_with_quality(&mut jpeg, QUALITY)).map_err(refuse)?;
    Ok(FaceData {
        name: face.name.clone(),
        jpeg: BASE64_STANDARD.encode(jpeg.get_ref()),
        landmarks: BASE64_STANDARD.encode(bytemuck::cast_slice(face.landmarks.as_flattened())),
        scale: scale(face),
    })
}

fn scale(face: &ViewFace) -> f64 {
    (f64::from(SIDE) / f64::from(face.picture.width().max(face.picture.height()))).min(1.0)
}

/// From the least plausible strength to the largest, in equal steps on each side of 0; a side where there is nothing to go to has none.
fn changes(strength: f32, [low, high]: [f32; 2]) -> Vec<f32> {
    let side = |to: f32| move |k: usize| to * k as f32 / STEPS as f32;
    let less = (low - strength).min(0.0);
    let more = (high - strength).max(0.0);
    let mut changes = vec![0.0];
    if less < 0.0 {
        changes.splice(0..0, (1..=STEPS).rev().map(side(less)));
    }
    if more > 0.0 {
        changes.extend((1..=STEPS).map(side(more)));
    }
    changes
}

/// A grid over a face on which warps are written, in pixels of the page's picture.
struct Nodes {
    origin: [f64; 2],
    cell: f64,
    columns: usize,
    rows: usize,
    /// Pixels of the page's picture to one of the landmarks'.
    scale: f64,
}

impl Nodes {
    /// `unit`: the face's, in pixels of the landmarks' picture.
    fn new<'w>(scale: f64, unit: f64, warps: impl Iterator<Item = &'w Warp>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for warp in warps {
            let [least, most] = warp.bounds();
            for axis in 0..2 {
                // Centres of pixels, not corners, are at whole numbers.
                low[axis] = low[axis].min((least[axis] + 0.5) * scale - 0.5);
                high[axis] = high[axis].max((most[axis] + 0.5) * scale - 0.5);
            }
        }
        let cell = unit * scale / CELLS;
        let count = |axis: usize| ((high[axis] - low[axis]) / cell).ceil() as usize + 1;
        Self { origin: low, cell, columns: count(0), rows: count(1), scale }
    }

    /// The displacement at a place of the page's picture, in its pixels.
    fn exact(&self, warp: &Warp, place: [f64; 2]) -> [f64; 2] {
        warp.displacement(place.map(|x| (x + 0.5) / self.scale - 0.5)).map(|d| d * self.scale)
    }

    fn place(&self, node: usize) -> [f64; 2] {
        let along = |axis: usize, k: usize| self.origin[axis] + k as f64 * self.cell;
        [along(0, node % self.columns), along(1, node / self.columns)]
    }

    fn read(&self, warp: &Warp) -> Vec<[i16; 2]> {
        // A cast saturates; no displacement is longer than the picture.
        let node = |node: usize| self.exact(warp, self.place(node)).map(|d| (PARTS * d).round() as i16);
        (0..self.columns * self.rows).map(node).collect()
    }

    /// Distance of the mean of two warps from the exact one halfway, in the middle of the cells in which anything moves.
    fn between(&self, pair: &[Vec<[i16; 2]>], exact: &Warp) -> Vec<f64> {
        let corners = |at: usize| [at, at + 1, at + self.columns, at + self.columns + 1];
        let inside = |at: &usize| at % self.columns + 1 < self.columns && at / self.columns + 1 < self.rows;
        let off = |at: usize| {
            let exact = self.exact(exact, self.place(at).map(|x| x + self.cell / 2.0));
            let mean = |axis: usize| {
                let all = pair.iter().flat_map(|warp| corners(at).map(|node| f64::from(warp[node][axis]))).sum::<f64>();
                all / (8.0 * PARTS)
            };
            (exact != [0.0; 2]).then(|| (mean(0) - exact[0]).hypot(mean(1) - exact[1]))
        };
        (0..self.columns * self.rows).filter(inside).filter_map(off).collect()
    }
}

fn mean_and_most(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (count, sum, most) = values.fold((0, 0.0, 0.0), |(n, sum, most), x| (n + 1, sum + x, x.max(most)));
    [sum / f64::from(count.max(1)), most]
}
