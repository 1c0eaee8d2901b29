//! Sampling a picture at the places that a map names.

use image::{DynamicImage, ImageBuffer, Pixel};
use nalgebra::Vector2;
use rayon::prelude::*;

use super::grid::Grid;

/// The picture cannot be sampled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("pictures of the pixel type {found} are not warped: save it with 8 or 16 bits a channel")]
pub struct ResampleError {
    /// The pixel type.
    found: String,
}

/// A channel as a number.
trait Channel: Copy + Send + Sync {
    fn get(self) -> f64;
    /// Rounded, and held inside the type's range.
    fn put(value: f64) -> Self;
}

impl Channel for u8 {
    fn get(self) -> f64 {
        f64::from(self)
    }
    fn put(value: f64) -> Self {
        // A cast saturates.
        value.round() as Self
    }
}

impl Channel for u16 {
    fn get(self) -> f64 {
        f64::from(self)
    }
    fn put(value: f64) -> Self {
        value.round() as Self
    }
}

/// The new picture: pixels that move are sampled by cubic convolution (Catmull-Rom), the others copied.
pub(super) fn resample(picture: &DynamicImage, grid: &Grid) -> Result<DynamicImage, ResampleError> {
    Ok(match picture {
        DynamicImage::ImageLuma8(buffer) => DynamicImage::ImageLuma8(sample(buffer, grid)),
        DynamicImage::ImageLumaA8(buffer) => DynamicImage::ImageLumaA8(sample(buffer, grid)),
        DynamicImage::ImageRgb8(buffer) => DynamicImage::ImageRgb8(sample(buffer, grid)),
        DynamicImage::ImageRgba8(buffer) => DynamicImage::ImageRgba8(sample(buffer, grid)),
        DynamicImage::ImageLuma16(buffer) => DynamicImage::ImageLuma16(sample(buffer, grid)),
        DynamicImage::ImageLumaA16(buffer) => DynamicImage::ImageLumaA16(sample(buffer, grid)),
        DynamicImage::ImageRgb16(buffer) => DynamicImage::ImageRgb16(sample(buffer, grid)),
        DynamicImage::ImageRgba16(buffer) => DynamicImage::ImageRgba16(sample(buffer, grid)),
        other => return Err(ResampleError { found: format!("{:?}", other.color()) }),
    })
}

fn sample<P>(picture: &ImageBuffer<P, Vec<P::Subpixel>>, grid: &Grid) -> ImageBuffer<P, Vec<P::Subpixel>>
where
    P: Pixel,
    P::Subpixel: Channel,
{
    let mut out = picture.clone();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let channels = usize::from(P::CHANNEL_COUNT);
    let old: &[P::Subpixel] = picture.as_raw();
    let row = |(y, row): (usize, &mut [P::Subpixel])| {
        for (x, pixel) in row.chunks_exact_mut(channels).enumerate() {
            let place = Vector2::new(x as f64, y as f64);
            let displacement = grid.at(place);
            if displacement == Vector2::zeros() {
                continue;
            }
            let from = place + displacement;
            let (columns, across) = taps(from.x, width);
            let (rows, down) = taps(from.y, height);
            for (channel, value) in pixel.iter_mut().enumerate() {
                let at = |row: usize, column: usize| old[(row * width + column) * channels + channel].get();
                let line = |row: usize| (0..4).map(|i| across[i] * at(row, columns[i])).sum::<f64>();
                *value = Channel::put((0..4).map(|i| down[i] * line(rows[i])).sum());
            }
        }
    };
    let samples: &mut [P::Subpixel] = &mut out;
    samples.par_chunks_exact_mut((width * channels).max(1)).enumerate().for_each(row);
    out
}

/// The four neighbours of a coordinate, repeated at the picture's edge, and their weights.
fn taps(at: f64, size: usize) -> ([usize; 4], [f64; 4]) {
    let floor = at.floor();
    let t = at - floor;
    let last = size.saturating_sub(1) as f64;
    let index = std::array::from_fn(|i| (floor + i as f64 - 1.0).clamp(0.0, last) as usize);
    let weights = [
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (-2.5 + 1.5 * t),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (-0.5 + 0.5 * t),
    ];
    (index, weights)
}
