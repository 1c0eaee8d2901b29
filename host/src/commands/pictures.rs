//! Pictures of faces with their landmarks.

use std::path::{Path, PathBuf};

use image::DynamicImage;
use kinesic::face::{Landmarks, POINTS};
use kinesic_host::face::{Face, landmarks, photo};
use miette::{IntoDiagnostic, miette};

use super::clips::NOTES;

/// A picture and where the face is in it.
pub struct Photographed {
    /// The picture's name in the table.
    pub name: String,
    pub picture: DynamicImage,
    pub landmarks: Landmarks,
}

/// Pictures with their lines of a table.
pub fn photographed(pictures: &[PathBuf], table: &Path) -> miette::Result<Vec<Photographed>> {
    let faces = landmarks::read(table, None).into_diagnostic()?;
    let one = |path: &PathBuf| {
        let face = find(&faces, path, table)?;
        let (picture, turned) = photo::open(path).into_diagnostic()?;
        if turned {
            NOTES.add(path, &["Turned upright, as its EXIF orientation says.".to_owned()]);
        }
        inside(&face.landmarks, &picture, path)?;
        Ok(Photographed { name: face.picture.clone(), picture, landmarks: face.landmarks })
    };
    pictures.iter().map(one).collect()
}

/// The line of the table about a picture.
fn find<'a>(table: &'a [Face], picture: &Path, path: &Path) -> miette::Result<&'a Face> {
    let name = picture.file_name().unwrap_or_default().to_string_lossy();
    if let [only] = table {
        return Ok(only);
    }
    let stem = |name: &str| Path::new(name).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let exact = table.iter().find(|face| face.picture == name);
    exact.or_else(|| table.iter().find(|face| stem(&face.picture) == stem(&name))).ok_or_else(|| {
        miette!(
            help = "add its line, or give a table with one line",
            "{}: none of its {} lines is about {name}; the first is about {}",
            path.display(),
            table.len(),
            table.first().map_or("", |face| &face.picture)
        )
    })
}

/// Landmarks of another picture, or of this one at another size, would warp the wrong place.
fn inside(landmarks: &Landmarks, picture: &DynamicImage, path: &Path) -> miette::Result<()> {
    let (width, height) = (picture.width() as f32, picture.height() as f32);
    let count = landmarks.iter().filter(|[x, y]| (0.0..width).contains(x) && (0.0..height).contains(y)).count();
    if 2 * count >= POINTS {
        return Ok(());
    }
    Err(miette!(
        help = "landmarks are in pixels of this very picture, from its top left corner",
        "{}: only {count} of the {POINTS} landmarks are inside the picture of {width} x {height} pixels",
        path.display()
    ))
}
