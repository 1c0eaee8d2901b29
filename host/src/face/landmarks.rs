//! Tables of landmarks: one face a line, `x0,y0,...,x67,y67` and what is known about it.

use std::path::{Path, PathBuf};

use kinesic::face::{FaceFrame, Landmarks, POINTS};

use crate::cells;

/// Names under which tables hold the picture's file name, or its number, and the person's.
const PICTURE: [&str; 7] = ["image", "imageid", "file", "filename", "imagepath", "frame", "face"];
const PERSON: [&str; 2] = ["subject", "person"];

/// A face of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Name of the picture.
    pub picture: String,
    /// Whose face it is; the picture's name where the table does not say.
    pub person: String,
    /// How strong the expression is, where somebody judged it: 0 and 1, or steps in between.
    pub label: Option<f64>,
    /// The landmarks.
    pub landmarks: Landmarks,
    /// Line in the file.
    pub line: u64,
}

/// Why a table of landmarks cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct LandmarksError {
    /// The file.
    pub path: PathBuf,
    /// Where and how.
    pub fault: LandmarksFault,
}

/// What is wrong with a table of landmarks, and where. Lines count from 1, the header is line 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // The messages say what the fields are.
pub enum LandmarksFault {
    #[error("cannot be read: {error}. Check the path")]
    Io { error: String },
    #[error("the file is empty, expected a header 'image,subject,smile,x0,y0,...,x67,y67' and one line a face")]
    Empty,
    #[error("there is a header and no face: expected one line a face")]
    NoFace,
    #[error("line {line}: not readable as CSV text: {error}. Save the file as UTF-8 CSV with commas")]
    Csv { line: u64, error: String },
    #[error(
        "line 1: the column '{column}' is missing. Expected x0, y0, ... x67, y67: 68 landmarks in the order of iBUG 300-W \
         (0-16 contour, 17-26 brows, 27-35 nose, 36-47 eyes, 48-67 mouth)"
    )]
    MissingColumn { column: String },
    #[error(
        "line 1: the columns go on to {last}, the header of a face mesh (mediapipe has 468 or 478 points): expected the 68 landmarks of \
         iBUG 300-W. Take those points of the mesh that are theirs, in their order, as x0 to y67"
    )]
    Mesh { last: String },
    #[error("line {line}: its detector says that it found no face (success is 0). Remove the line")]
    Failed { line: u64 },
    #[error(
        "line {line}: {count} landmarks are far away from all others, which no face has: {list}. Detect the face again, or remove the line"
    )]
    Astray { line: u64, count: usize, list: String },
    #[error(
        "line 1: no column names the picture: expected one of image, image_id, file, filename, image_path, frame, face"
    )]
    NoPicture,
    #[error(
        "line 1: no column '{attribute}' (nor 'posed_{attribute}' or '{attribute}_true'). Columns beside the landmarks: {found}"
    )]
    NoAttribute { attribute: String, found: String },
    #[error(
        "line {line}: {found} cells, the header has {expected}. The line is cut off or has a comma too many; correct or remove it"
    )]
    Row { line: u64, found: usize, expected: usize },
    #[error("line {line}, column '{column}': '{found}' is not a finite number. Write it like 251.5")]
    NotANumber { line: u64, column: String, found: String },
    #[error("line {line}: the landmarks are in one place, or the eyes are: this is no face. Remove the line")]
    Degenerate { line: u64 },
    #[error(
        "line {line}: {count} landmarks are at {at}, which is what detectors write for those they did not find: {list}. Detect the face \
         again, or remove the line"
    )]
    NotFound { line: u64, count: usize, at: String, list: String },
    #[error(
        "line {line}: all landmarks lie within {size:.2} pixels: they look like shares of the picture from 0 to 1. Multiply x by its \
         width and y by its height"
    )]
    Normalised { line: u64, size: f32 },
    #[error(
        "line {line}: the brows are below the mouth: expected y to point down in the picture, and landmarks 36-41 to be the \
         right eye of the person, on the left in the picture. Turn y round (height - y), or mirror the numbering"
    )]
    UpsideDown { line: u64 },
}

/// The faces of a CSV file. `attribute` names the column of judgements; without one no face has a label.
///
/// `smile` is looked for as `smile`, then as `posed_smile`, then as `smile_true`; an empty cell is a face that nobody judged.
pub fn read(path: &Path, attribute: Option<&str>) -> Result<Vec<Face>, LandmarksError> {
    let refuse = |fault| LandmarksError { path: path.to_owned(), fault };
    let bytes = crate::files::read(path).map_err(|error| refuse(LandmarksFault::Io { error: error.to_string() }))?;
    parse(&bytes, attribute).map_err(refuse)
}

/// The faces of the bytes of a CSV file; see [`read`].
pub fn parse(bytes: &[u8], attribute: Option<&str>) -> Result<Vec<Face>, LandmarksFault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.trim_ascii().is_empty() {
        return Err(LandmarksFault::Empty);
    }
    let (_, mut reader) = cells::reader(bytes);
    let broken =
        |e: csv::Error| LandmarksFault::Csv { line: e.position().map_or(1, |p| p.line()), error: e.to_string() };
    let header = reader.headers().map_err(broken)?.clone();
    let columns = Columns::find(&header, attribute)?;
    let mut faces = Vec::new();
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(broken)? {
        let line = record.position().map_or(0, |p| p.line());
        if record.len() != header.len() {
            return Err(LandmarksFault::Row { line, found: record.len(), expected: header.len() });
        }
        faces.push(columns.face(&header, &record, line)?);
    }
    if faces.is_empty() { Err(LandmarksFault::NoFace) } else { Ok(faces) }
}

/// Where things stand in a line.
struct Columns {
    picture: usize,
    person: Option<usize>,
    label: Option<usize>,
    /// Whether the detector found a face, as OpenFace says.
    success: Option<usize>,
    points: Vec<[usize; 2]>,
}

impl Columns {
    fn find(header: &csv::StringRecord, attribute: Option<&str>) -> Result<Self, LandmarksFault> {
        let names: Vec<String> = header.iter().map(cells::plain).collect();
        let find = |name: &str| names.iter().position(|n| n == name);
        // OpenFace writes x_0, others X0 or landmark_0_x.
        let column = |axis: &str, i: usize| {
            let forms = [format!("{axis}{i}"), format!("landmark{i}{axis}"), format!("landmark{axis}{i}")];
            forms.iter().find_map(|form| find(form))
        };
        let point =
            |axis: &str, i| column(axis, i).ok_or(LandmarksFault::MissingColumn { column: format!("{axis}{i}") });
        let points = (0..POINTS).map(|i| Ok([point("x", i)?, point("y", i)?]));
        let points = points.collect::<Result<Vec<_>, _>>()?;
        if let Some(last) = (POINTS..1000).map_while(|i| column("x", i)).last() {
            return Err(LandmarksFault::Mesh { last: header.get(last).unwrap_or_default().to_owned() });
        }
        let named = |attribute: &str| {
            let names = [attribute.to_owned(), format!("posed_{attribute}"), format!("{attribute}_true")];
            names.iter().find_map(|name| find(&cells::plain(name))).ok_or_else(|| {
                let others = header.iter().enumerate().filter(|(at, _)| !points.as_flattened().contains(at));
                let found = others.map(|(_, name)| name).collect::<Vec<_>>().join(", ");
                LandmarksFault::NoAttribute { attribute: attribute.to_owned(), found }
            })
        };
        Ok(Self {
            picture: PICTURE.iter().find_map(|name| find(name)).ok_or(LandmarksFault::NoPicture)?,
            person: PERSON.iter().find_map(|name| find(name)),
            label: attribute.map(named).transpose()?,
            success: find("success"),
            points,
        })
    }

    fn face(&self, header: &csv::StringRecord, record: &csv::StringRecord, line: u64) -> Result<Face, LandmarksFault> {
        let text = |at: usize| record.get(at).unwrap_or_default();
        let number = |at: usize| match text(at).parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => {
                let column = header.get(at).unwrap_or_default().to_owned();
                Err(LandmarksFault::NotANumber { line, column, found: text(at).to_owned() })
            }
        };
        if self.success.is_some_and(|at| text(at).parse() == Ok(0.0)) {
            return Err(LandmarksFault::Failed { line });
        }
        let mut landmarks: Landmarks = [[0.0; 2]; POINTS];
        for (point, at) in landmarks.iter_mut().zip(&self.points) {
            *point = [number(at[0])? as f32, number(at[1])? as f32];
        }
        missing(&landmarks, line)?;
        let frame = FaceFrame::of(&landmarks).ok_or(LandmarksFault::Degenerate { line })?;
        let shape = frame.shape(&landmarks);
        let height = |points: &[[f32; 2]]| points.iter().map(|p| p[1]).sum::<f32>() / points.len() as f32;
        if height(&shape[..5]) > height(&shape[31..]) {
            return Err(LandmarksFault::UpsideDown { line });
        }
        let label = self.label.filter(|at| !text(*at).is_empty()).map(number).transpose()?;
        Ok(Face {
            picture: text(self.picture).to_owned(),
            person: text(self.person.unwrap_or(self.picture)).to_owned(),
            label,
            landmarks,
            line,
        })
    }
}

/// Landmarks of the contour: the first of all, and the only ones that a picture may cut off.
const CONTOUR: usize = 17;
/// Landmarks further from the middle than so many times half of them are: of 6,039 faces in the wild none is further than 4.4.
const ASTRAY: f32 = 8.0;

/// Refuses landmarks that were not found, or that are no pixels.
fn missing(landmarks: &Landmarks, line: u64) -> Result<(), LandmarksFault> {
    let which = |is: &dyn Fn(usize, &[f32; 2]) -> bool| {
        let all = landmarks.iter().enumerate().filter(|(i, p)| is(*i, p)).map(|(i, _)| i);
        all.collect::<Vec<_>>()
    };
    let list = |all: &[usize]| all.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
    let zeros = which(&|_, p| *p == [0.0; 2]);
    // One landmark of the contour may lie in the corner.
    let zeros = if zeros.iter().all(|i| *i < CONTOUR) && zeros.len() == 1 { Vec::new() } else { zeros };
    // A place that is marked in one coordinate is marked as well.
    for (at, lost) in [("-1,-1", which(&|_, p| p.contains(&-1.0))), ("0,0", zeros)] {
        // All in one place are no face, which is said elsewhere.
        if !lost.is_empty() && lost.len() < POINTS {
            return Err(LandmarksFault::NotFound { line, count: lost.len(), at: at.into(), list: list(&lost) });
        }
    }
    let size = landmarks.as_flattened().iter().map(|x| x.abs()).fold(0.0, f32::max);
    let spread = landmarks.iter().any(|p| p != &landmarks[0]);
    if spread && size <= 2.0 {
        return Err(LandmarksFault::Normalised { line, size });
    }
    let median = |mut all: Vec<f32>| *all.select_nth_unstable_by(POINTS / 2, f32::total_cmp).1;
    let middle = [0, 1].map(|axis| median(landmarks.iter().map(|p| p[axis]).collect()));
    let away = |p: &[f32; 2]| (p[0] - middle[0]).hypot(p[1] - middle[1]);
    let half = median(landmarks.iter().map(away).collect());
    let astray = which(&|_, p| half > 0.0 && away(p) > ASTRAY * half);
    match astray.len() {
        0 => Ok(()),
        count => Err(LandmarksFault::Astray { line, count, list: list(&astray) }),
    }
}
