//! Figures in cells: a row a clip on a sheet, a cell a clip in a film.

use super::actor::{Actor, Figure, Side};
use super::drawing::{Colour, Drawing, GROUND, LEFT, MIDDLE, Mark, RIGHT, TEXT};
use super::glyphs;
use super::view::View;

/// White around a figure, pixels.
const PAD: f64 = 10.0;
/// Height of a capital, pixels.
const LETTER: f64 = 8.0;
/// A line of text with what is above and below it, pixels.
const LINE: f64 = 18.0;
/// The narrowest cell: a time fits below it, pixels.
const NARROWEST: f64 = 64.0;
/// Cells beside each other in a film.
const BESIDE: usize = 4;
/// Characters of a name above a cell of a film.
const NAME: usize = 24;
/// Distance of the marks on the ground, m.
const MARK: f64 = 0.5;
/// Pixels of a side, and of a picture.
const MOST: [f64; 2] = [16_384.0, 5e7];

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// Nothing to draw.
    #[error("found no frame to draw, expected a clip with at least one")]
    Empty,
    /// Nobody can look at it.
    #[error(
        "the picture would have {width} x {height} pixels, expected at most {} a side and {} million in all: take fewer clips, fewer --frames or \
         a smaller --size",
        MOST[0],
        MOST[1] / 1e6
    )]
    Large {
        /// Pixels.
        width: f64,
        /// Pixels.
        height: f64,
    },
}

/// The place that every figure has, m, and how large a metre is.
#[derive(Clone, Copy, Debug)]
struct Cell {
    half: f64,
    low: f64,
    high: f64,
    scale: f64,
}

impl Cell {
    /// One that holds all figures; the largest is `size` pixels high, or as wide as that and two thirds.
    fn around<'f>(figures: impl Iterator<Item = &'f Figure>, view: View, size: f64) -> Result<Self, LayoutError> {
        let mut found = None;
        for figure in figures {
            let [mut half, mut low, mut high] = found.unwrap_or([0.0, 0.0, 0.0f64]);
            let ends = figure.strokes.iter().flat_map(|(from, to, _)| [*from, *to]);
            for (point, radius) in ends.map(|end| (end, 0.0)).chain(figure.head) {
                let seen = view.project(&point);
                half = f64::max(half, seen.x.abs() + radius);
                low = f64::min(low, seen.y - radius);
                high = f64::max(high, seen.y + radius);
            }
            found = Some([half, low, high]);
        }
        let [half, low, high] = found.ok_or(LayoutError::Empty)?;
        // Seen from the side the ground is the lowest line, whatever of a foot is drawn below it.
        let cell = Self { half, low, high, scale: 1.0 };
        Ok(Self { scale: size / cell.largest(), ..cell })
    }

    /// What `size` pixels are, m.
    fn largest(&self) -> f64 {
        (self.high - self.low).max(1.2 * self.half).max(0.01)
    }

    fn width(&self) -> f64 {
        (2.0 * self.half * self.scale + 2.0 * PAD).max(NARROWEST).ceil()
    }

    fn height(&self) -> f64 {
        ((self.high - self.low) * self.scale + 2.0 * PAD).ceil()
    }

    /// Draws a figure in the cell with this left upper corner.
    fn draw(&self, marks: &mut Vec<Mark>, actor: &Actor, figure: &Figure, view: View, corner: [f64; 2]) {
        let (middle, ground) = (corner[0] + 0.5 * self.width(), corner[1] + PAD + self.high * self.scale);
        self.ground(marks, actor, figure, view, [corner[0], middle, ground]);
        let place = |point: &nalgebra::Vector3<f64>| {
            let seen = view.project(point);
            ([middle + self.scale * seen.x, ground - self.scale * seen.y], seen.z)
        };
        let width = (self.largest() * self.scale / 60.0).clamp(1.2, 12.0);
        let mut parts: Vec<(f64, Mark)> = figure
            .strokes
            .iter()
            .map(|(from, to, side)| {
                let ((from, near), (to, far)) = (place(from), place(to));
                (near + far, Mark::Line { from, to, width, colour: colour(*side) })
            })
            .collect();
        if let Some((at, radius)) = &figure.head {
            let (middle, depth) = place(at);
            parts.push((2.0 * depth, Mark::Disc { middle, radius: radius * self.scale, colour: MIDDLE }));
        }
        // What is nearer covers what is farther away.
        parts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        marks.extend(parts.into_iter().map(|(_, mark)| mark));
    }

    /// The line of the ground, or its net from above; marks on it stay where they are when a person walks on.
    fn ground(
        &self,
        marks: &mut Vec<Mark>,
        actor: &Actor,
        figure: &Figure,
        view: View,
        [left, middle, ground]: [f64; 3],
    ) {
        let right = left + self.width();
        let mut line = |from, to| marks.push(Mark::Line { from, to, width: 1.0, colour: GROUND });
        let place = view.project(&nalgebra::Vector3::new(figure.place.x, 0.0, figure.place.z));
        let steps = |at: f64, low: f64, high: f64| {
            let first = ((low + at) / MARK).ceil() as i64;
            let last = ((high + at) / MARK).floor() as i64;
            (first..=last).map(move |step| step as f64 * MARK - at)
        };
        let inside = 0.5 * (right - left) / self.scale;
        if !view.has_horizon() {
            let net = |at, low, high| steps(at, low, high).collect::<Vec<_>>();
            for x in net(place.x, -inside, inside) {
                for y in net(place.y, self.low, self.high) {
                    let at = [middle + self.scale * x, ground - self.scale * y];
                    line([at[0] - 2.0, at[1]], [at[0] + 2.0, at[1]]);
                    line([at[0], at[1] - 2.0], [at[0], at[1] + 2.0]);
                }
            }
            return;
        }
        line([left, ground], [right, ground]);
        if actor.travels() {
            for x in steps(place.x, -inside, inside) {
                let x = middle + self.scale * x;
                line([x, ground], [x, ground + 4.0]);
            }
        }
    }
}

fn colour(side: Side) -> Colour {
    match side {
        Side::Left => LEFT,
        Side::Right => RIGHT,
        Side::Middle => MIDDLE,
    }
}

fn text(marks: &mut Vec<Mark>, at: [f64; 2], text: String) {
    marks.push(Mark::Text { at, height: LETTER, colour: TEXT, text });
}

/// Width of a text, pixels.
fn length(text: &str) -> f64 {
    LETTER / glyphs::CAPITAL * glyphs::ADVANCE * text.chars().count() as f64
}

fn drawing(width: f64, height: f64, marks: Vec<Mark>) -> Result<Drawing, LayoutError> {
    let (width, height) = (width.ceil(), height.ceil());
    if !(width.max(height) <= MOST[0] && width * height <= MOST[1]) {
        return Err(LayoutError::Large { width, height });
    }
    Ok(Drawing { width: width as u32, height: height as u32, marks })
}

/// A contact sheet: a row an actor, with the frames that are named beside it. The largest figure is `size` pixels high; all have one scale.
pub fn sheet(rows: &[(Actor, Vec<usize>)], view: View, size: f64) -> Result<Drawing, LayoutError> {
    let figures: Vec<Vec<Figure>> =
        rows.iter().map(|(actor, frames)| frames.iter().map(|frame| actor.figure(*frame)).collect()).collect();
    let cell = Cell::around(figures.iter().flatten(), view, size)?;
    let columns = figures.iter().map(Vec::len).max().unwrap_or(0);
    let titles = rows.iter().map(|(actor, _)| length(&title(actor))).fold(0.0, f64::max);
    let width = (cell.width() * columns as f64).max(titles) + 2.0 * PAD;
    let height = (cell.height() + 2.0 * LINE) * rows.len() as f64;
    let mut marks = Vec::new();
    for (row, ((actor, frames), figures)) in rows.iter().zip(&figures).enumerate() {
        let top = (cell.height() + 2.0 * LINE) * row as f64;
        text(&mut marks, [PAD, top + LINE - 4.0], title(actor));
        for (column, (frame, figure)) in frames.iter().zip(figures).enumerate() {
            let left = PAD + cell.width() * column as f64;
            cell.draw(&mut marks, actor, figure, view, [left, top + LINE]);
            let time = format!("{:.2} s", actor.time(*frame));
            let start = left + 0.5 * (cell.width() - length(&time));
            text(&mut marks, [start, top + LINE + cell.height() + LETTER], time);
        }
    }
    drawing(width, height, marks)
}

fn title(actor: &Actor) -> String {
    format!("{}, {:.2} s", actor.name, actor.duration())
}

/// Actors beside each other while time goes on. A short clip waits in its last frame for the longest.
#[derive(Clone, Debug)]
pub struct Film<'a> {
    actors: &'a [Actor],
    view: View,
    cell: Cell,
    step: f64,
    frames: usize,
}

impl<'a> Film<'a> {
    /// A film with `step` seconds from picture to picture; `size` as for [`sheet`].
    pub fn new(actors: &'a [Actor], view: View, size: f64, step: f64) -> Result<Self, LayoutError> {
        let longest = actors.iter().map(Actor::duration).fold(0.0, f64::max);
        let frames = 1 + (longest / step + 1e-6).floor() as usize;
        let at = |actor: &Actor, frame: usize| actor.figure(actor.frame_at(step * frame as f64));
        let all = actors.iter().flat_map(|actor| (0..frames).map(move |frame| (actor, frame)));
        let figures: Vec<Figure> = all.map(|(actor, frame)| at(actor, frame)).collect();
        let cell = Cell::around(figures.iter(), view, size)?;
        let film = Self { actors, view, cell, step, frames };
        film.drawing(0)?;
        Ok(film)
    }

    /// Number of pictures.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Seconds from picture to picture.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// A picture.
    pub fn drawing(&self, frame: usize) -> Result<Drawing, LayoutError> {
        let name = |actor: &Actor| match actor.name.chars().count() > NAME {
            true => actor.name.chars().take(NAME - 2).chain("..".chars()).collect(),
            false => actor.name.clone(),
        };
        let widest = self.actors.iter().map(|actor| length(&name(actor)) + PAD).fold(self.cell.width(), f64::max);
        let columns = self.actors.len().min(BESIDE);
        let rows = self.actors.len().div_ceil(columns.max(1));
        let tall = self.cell.height() + LINE;
        let mut marks = Vec::new();
        for (index, actor) in self.actors.iter().enumerate() {
            let (left, top) = (PAD + widest * (index % columns) as f64, tall * (index / columns) as f64);
            text(&mut marks, [left, top + LINE - 4.0], name(actor));
            let figure = actor.figure(actor.frame_at(self.step * frame as f64));
            let corner = [left + 0.5 * (widest - self.cell.width()), top + LINE];
            self.cell.draw(&mut marks, actor, &figure, self.view, corner);
        }
        let time = format!("{:.2} s", self.step * frame as f64);
        text(&mut marks, [PAD, tall * rows as f64 + LETTER], time);
        drawing(widest * columns as f64 + 2.0 * PAD, tall * rows as f64 + LINE, marks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::gait::{Manner, walk};
    use crate::rig::frame_of;
    use crate::robot::look::Look;
    use crate::robot::{Defaults, Machine, ServoTable};

    fn actor(name: &str, seconds: f64) -> Actor {
        let clip = walk(&Manner::NEUTRAL, seconds, 30.0, 0.0, 1);
        let map = JointMap::detect(&clip.skeleton);
        Actor::body(name, clip, map.as_ref())
    }

    #[test]
    fn a_sheet_has_a_row_a_clip_with_names_and_times() {
        let rows = [(actor("a.bvh", 2.0), vec![0, 30, 59]), (actor("b.bvh", 1.0), vec![5])];
        for view in [View::Oblique, View::Front, View::Side, View::Top] {
            let drawing = sheet(&rows, view, 150.0).unwrap();
            let svg = drawing.svg();
            for text in ["a.bvh, 1.97 s", "b.bvh, 0.97 s", ">0.00 s<", ">1.00 s<", ">0.17 s<"] {
                assert!(svg.contains(text), "{view:?}: no {text}");
            }
            assert_eq!(svg.matches("<circle").count(), 4);
            assert!(svg.contains("#0072b2") && svg.contains("#d55e00"));
            let places = drawing.marks.iter().map(|mark| match mark {
                Mark::Line { from, .. } => *from,
                Mark::Disc { middle, .. } => *middle,
                Mark::Text { at, .. } => *at,
            });
            for [x, y] in places {
                let inside =
                    (0.0..=f64::from(drawing.width)).contains(&x) && (0.0..=f64::from(drawing.height)).contains(&y);
                assert!(inside, "{view:?}: {x} {y} of {} {}", drawing.width, drawing.height);
            }
        }
        assert_eq!(sheet(&[], View::Front, 150.0).unwrap_err(), LayoutError::Empty);
        let error = sheet(&rows, View::Front, 15_000.0).unwrap_err().to_string();
        assert!(error.contains("--size") && error.contains("pixels"), "{error}");
    }

    #[test]
    fn marks_on_the_ground_stay_behind_a_walker() {
        let walker = actor("a.bvh", 2.0);
        let film = Film::new(std::slice::from_ref(&walker), View::Side, 150.0, 0.1).unwrap();
        assert_eq!(film.frames(), 20);
        let ticks = |frame: usize| {
            let marks = film.drawing(frame).unwrap().marks;
            let tick = |mark: &Mark| match mark {
                Mark::Line { from, to, colour: GROUND, .. } if from[0] == to[0] => Some(from[0]),
                _ => None,
            };
            marks.iter().filter_map(tick).collect::<Vec<_>>()
        };
        let (first, next) = (ticks(5), ticks(6));
        assert!(!first.is_empty());
        let way = film.cell.scale * (walker.figure(18).place.z - walker.figure(15).place.z);
        assert!(way > 1.0 && next.iter().any(|x| (x + way - first[0]).abs() < 0.5), "{way} {first:?} {next:?}");
    }

    #[test]
    fn a_small_robot_fills_its_cell_and_its_slider_slides() {
        let table = "[[servo]]\nname = \"lift\"\nunit = \"mm\"\nmin = 0\nmax = 80\n[[servo]]\nname = \"tilt\"\nparent = \"lift\"\nunit = \"deg\"\nmin = -90\nmax = 90\naxis = [0, 1, 0]\n";
        let machine = Machine::of_table(&ServoTable::parse(table).unwrap(), 50.0, Defaults::default()).unwrap();
        let frames: Vec<_> = (0..8).map(|at| frame_of(&[0.01 * f64::from(at), 0.1 * f64::from(at), 0.0])).collect();
        let clip = machine.rig.clip_of(&frames, 0.02);
        let look = Look::of_machine(&machine);
        let [low, high] = [0, 7].map(|at| look.sticks(clip.coordinates(at).unwrap())[1].0.y);
        assert!((high - low - 0.07).abs() < 1e-6, "{low} {high}");
        let actor = Actor::machine("move", clip, look.clone());
        let drawing = sheet(&[(actor, (0..8).collect())], View::Oblique, 110.0).unwrap();
        let lines = drawing.svg().matches("stroke-width=\"1.8\"").count();
        assert_eq!(lines, 8 * look.sticks(&[]).len());
        assert!((110..=190).contains(&drawing.height), "{}", drawing.height);
    }
}
