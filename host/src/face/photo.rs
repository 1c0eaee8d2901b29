//! Pictures from files: whole, or refused.

use std::path::{Path, PathBuf};

use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, ImageResult};

use crate::files;

/// Why a picture cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PhotoError {
    /// The system refused.
    #[error("{}: the picture cannot be read: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: std::io::Error,
    },
    /// No picture, or a damaged one.
    #[error("{}: no picture that can be read: {error}. Save it as JPEG or PNG", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: ImageError,
    },
    /// A JPEG without its end. Its decoder would fill the rest with grey.
    #[error("{}: found a JPEG of {found} bytes without its end mark, expected the whole picture: copy it again", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// Its length.
        found: usize,
    },
}

/// Reads a picture, by its content whatever its name, and says whether it was turned as its EXIF orientation asks.
pub fn open(path: &Path) -> Result<(DynamicImage, bool), PhotoError> {
    let path = || path.to_owned();
    let bytes = files::read(&path()).map_err(|error| PhotoError::Io { path: path(), error })?;
    if bytes.starts_with(&[0xff, START]) && !has_end(&bytes) {
        return Err(PhotoError::Cut { path: path(), found: bytes.len() });
    }
    upright(&bytes).map_err(|error| PhotoError::Image { path: path(), error })
}

/// The picture as a viewer shows it: a phone writes it as its sensor lies, and EXIF says how to turn it.
fn upright(bytes: &[u8]) -> ImageResult<(DynamicImage, bool)> {
    let mut decoder = ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format()?.into_decoder()?;
    let orientation = decoder.orientation()?;
    let mut picture = DynamicImage::from_decoder(decoder)?;
    picture.apply_orientation(orientation);
    Ok((picture, orientation != Orientation::NoTransforms))
}

/// Marks of a JPEG: begin, end, begin of a scan; restarts are without a length, as begin and end.
const START: u8 = 0xd8;
const END: u8 = 0xd9;
const SCAN: u8 = 0xda;
const RESTARTS: std::ops::RangeInclusive<u8> = 0xd0..=0xd7;

/// Walks the segments of a JPEG up to its end mark. (An end mark alone says nothing: the small picture inside has one too.)
fn has_end(bytes: &[u8]) -> bool {
    let mut at = 2;
    let mut in_scan = false;
    while let Some([mark, kind]) = bytes.get(at..at + 2).and_then(|pair| <[u8; 2]>::try_from(pair).ok()) {
        // Data of a scan: a byte of 255 is followed by 0. Before any mark there may be more bytes of 255.
        if mark != 0xff || kind == 0xff || in_scan && (kind == 0 || RESTARTS.contains(&kind)) {
            at += 1;
            continue;
        }
        if kind == END {
            return true;
        }
        let Some(length) = bytes.get(at + 2..at + 4) else { return false };
        in_scan = kind == SCAN;
        at += 2 + usize::from(u16::from_be_bytes([length[0], length[1]])).max(2);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::jpeg::JpegEncoder;

    #[test]
    fn a_jpeg_that_is_cut_anywhere_is_refused() {
        let picture = DynamicImage::ImageRgb8(image::RgbImage::from_fn(40, 30, |x, y| {
            image::Rgb([(6 * x) as u8, (8 * y) as u8, 99])
        }));
        let mut bytes = Vec::new();
        picture.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, 90)).unwrap();
        // A camera's file: a small picture with an end of its own in front.
        let small = [&[0xff, 0xe1][..], &(2 + bytes.len() as u16).to_be_bytes(), &bytes].concat();
        let bytes = [&bytes[..2], &small, &bytes[2..]].concat();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.jpg");
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(open(&path).unwrap().0.width(), 40);
        std::fs::write(&path, [&bytes[..], &[0; 9]].concat()).unwrap();
        assert!(open(&path).is_ok(), "bytes after the end do no harm");
        for len in 2..bytes.len() {
            std::fs::write(&path, &bytes[..len]).unwrap();
            assert!(matches!(open(&path), Err(PhotoError::Cut { found, .. }) if found == len), "cut to {len} bytes");
        }
    }
}
