//! Pictures as files: PNG of a sheet, GIF and animated PNG of a film.

use std::collections::HashMap;
use std::io::Cursor;

use image::{ImageFormat, RgbImage};

use super::drawing::{Colour, Drawing, GROUND, LEFT, MIDDLE, RIGHT, TEXT};
use super::layout::{Film, LayoutError};
use super::raster::render;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// It has no layout.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// PNG refused.
    #[error("the picture cannot be encoded: {0}")]
    Still(#[from] image::ImageError),
    /// GIF refused.
    #[error("the animation cannot be encoded: {0}")]
    Gif(#[from] gif::EncodingError),
    /// Animated PNG refused.
    #[error("the animation cannot be encoded: {0}")]
    Png(#[from] png::EncodingError),
}

/// A format of pictures that move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moving {
    /// GIF: plays everywhere; times are whole hundredths of a second.
    Gif,
    /// Animated PNG.
    Png,
}

/// Steps from white to each colour: edges are smooth.
const SHADES: u32 = 16;
const COLOURS: [Colour; 5] = [LEFT, RIGHT, MIDDLE, GROUND, TEXT];

/// A drawing as PNG.
pub fn png(drawing: &Drawing) -> Result<Vec<u8>, EncodeError> {
    let mut bytes = Cursor::new(Vec::new());
    render(drawing).write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}

/// A film that plays for ever.
pub fn animation(film: &Film, format: Moving) -> Result<Vec<u8>, EncodeError> {
    let mut palette = Palette::new();
    let first = film.drawing(0)?;
    let mut bytes = Vec::new();
    match format {
        Moving::Gif => {
            // The layout allows 16,384 pixels a side.
            let (width, height) = (first.width as u16, first.height as u16);
            let mut encoder = gif::Encoder::new(&mut bytes, width, height, palette.colours.as_flattened())?;
            encoder.set_repeat(gif::Repeat::Infinite)?;
            for frame in 0..film.frames() {
                let buffer = palette.indices(&render(&film.drawing(frame)?)).into();
                let delay = (100.0 * film.step()).round().clamp(1.0, 6000.0) as u16;
                encoder.write_frame(&gif::Frame { width, height, buffer, delay, ..gif::Frame::default() })?;
            }
        }
        Moving::Png => {
            let mut encoder = png::Encoder::new(&mut bytes, first.width, first.height);
            encoder.set_color(png::ColorType::Indexed);
            encoder.set_depth(png::BitDepth::Eight);
            encoder.set_palette(palette.colours.concat());
            encoder.set_animated(film.frames() as u32, 0)?;
            encoder.set_frame_delay((1000.0 * film.step()).round().clamp(1.0, 60_000.0) as u16, 1000)?;
            let mut writer = encoder.write_header()?;
            for frame in 0..film.frames() {
                writer.write_image_data(&palette.indices(&render(&film.drawing(frame)?)))?;
            }
            writer.finish()?;
        }
    }
    Ok(bytes)
}

/// The colours of all drawings, each from white on.
struct Palette {
    colours: Vec<Colour>,
    known: HashMap<Colour, u8>,
}

impl Palette {
    fn new() -> Self {
        let shade =
            |colour: Colour, at: u32| colour.map(|full| (255 - (255 - u32::from(full)) * at / (SHADES - 1)) as u8);
        let colours = COLOURS.iter().flat_map(|colour| (0..SHADES).map(move |at| shade(*colour, at))).collect();
        Self { colours, known: HashMap::new() }
    }

    /// The nearest colour of every pixel.
    fn indices(&mut self, image: &RgbImage) -> Vec<u8> {
        let colours = &self.colours;
        let nearest = |pixel: Colour| {
            let far = |colour: &Colour| -> u32 {
                colour.iter().zip(pixel).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
            };
            let best = colours.iter().enumerate().min_by_key(|(_, colour)| far(colour));
            best.map_or(0, |(index, _)| index as u8)
        };
        image.pixels().map(|pixel| *self.known.entry(pixel.0).or_insert_with(|| nearest(pixel.0))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Actor, View, sheet};
    use super::*;
    use crate::clip::JointMap;
    use crate::gait::{Manner, walk};

    fn actors() -> Vec<Actor> {
        let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
        let map = JointMap::detect(&clip.skeleton);
        vec![Actor::body("a", clip.clone(), map.as_ref()), Actor::body("b", clip, map.as_ref())]
    }

    #[test]
    fn other_readers_find_the_pictures_and_their_times() {
        let actors = actors();
        let film = Film::new(&actors, View::Side, 80.0, 0.1).unwrap();
        let size = film.drawing(0).unwrap();
        let bytes = animation(&film, Moving::Gif).unwrap();
        let mut gif = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
        assert_eq!((u32::from(gif.width()), u32::from(gif.height())), (size.width, size.height));
        let (mut frames, mut coloured) = (0, 0);
        while let Some(frame) = gif.read_next_frame().unwrap() {
            assert_eq!(frame.delay, 10);
            coloured += frame.buffer.iter().filter(|index| **index % SHADES as u8 == 15).count();
            frames += 1;
        }
        assert_eq!(frames, film.frames());
        assert!(coloured > 100 * frames, "{coloured}");
        let bytes = animation(&film, Moving::Png).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames as usize, film.frames());
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        for _ in 0..film.frames() {
            assert_eq!(reader.next_frame(&mut buffer).unwrap().width, size.width);
        }
    }

    #[test]
    fn a_sheet_as_png_has_the_size_of_its_drawing() {
        let rows: Vec<_> = actors().into_iter().map(|actor| (actor.clone(), actor.even(4))).collect();
        let drawing = sheet(&rows, View::Front, 100.0).unwrap();
        let image = image::load_from_memory(&png(&drawing).unwrap()).unwrap();
        assert_eq!((image.width(), image.height()), (drawing.width, drawing.height));
    }
}
