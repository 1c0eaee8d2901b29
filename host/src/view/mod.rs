//! The page of `kinesic view`: one HTML file that plays packs on clips with the device's own code, compiled to WebAssembly.
//!
//! | file | holds |
//! |---|---|
//! | `mod` | what is shown, and the file |
//! | `fill` | the page from its template: parts in one pass, names as text, a Content-Security-Policy |
//! | `scene` | a pack on a clip: poses as the page reads them, and the digest of what the host makes of them |
//! | `machine` | a robot's links and solids |
//! | `emotion` | an emotion pack: its strengths, and digests of what the host plays |
//! | `face` | a face pack on a picture: landmarks, the picture's warps, and the digest of the host's landmarks |
//! | `assets/` | markup, style, scripts; `kinesic.wasm`, made of the crate `wasm/` by `./ci.sh wasm` |
//!
//! Everything is in the file: it opens from disk, without a network. The scripts share one scope, in this order: `engine.js` (the core,
//! motions), `machine.js` (links of robots), `solids.js` (their triangles), `scene.js` (figures on a canvas), `plots.js` (curves), `controls.js` (sliders), `emotion.js` (emotion strength),
//! `face.js` (pictures of faces), `app.js` (what is shown, time, what a test reads back).

mod emotion;
mod face;
mod fill;
mod machine;
mod scene;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use fill::{escape, fill, inert, policy};
use kinesic::LoadError;
use serde::Serialize;

pub use face::ViewFace;
use scene::hash;
pub use scene::{CHECKED, STRENGTH, digest};

use crate::face::warp::WarpError;
use crate::pack::PackFile;
use crate::prepare::{PrepareError, Source};
use crate::rig::RigError;
use crate::robot::look::Look;

/// The core for browsers.
pub const WASM: &[u8] = include_bytes!("assets/kinesic.wasm");

const PAGE: &str = include_str!("assets/page.html");
const STYLE: &str = include_str!("assets/style.css");
const SCRIPTS: [&str; 9] = [
    include_str!("assets/engine.js"),
    include_str!("assets/machine.js"),
    include_str!("assets/solids.js"),
    include_str!("assets/scene.js"),
    include_str!("assets/plots.js"),
    include_str!("assets/controls.js"),
    include_str!("assets/emotion.js"),
    include_str!("assets/face.js"),
    include_str!("assets/app.js"),
];

/// A pack to show.
#[derive(Clone, Debug)]
pub struct ViewPack {
    /// What it is called on the page.
    pub name: String,
    /// The pack.
    pub file: PackFile,
    /// How a robot looks; without, bones show it.
    pub look: Option<Look>,
}

/// A clip to show.
#[derive(Clone, Debug)]
pub struct ViewClip {
    /// What it is called on the page.
    pub name: String,
    /// The motion that goes through the packs.
    pub source: Source,
    /// What it should become, if that is known.
    pub target: Option<Source>,
}

/// What is on a page.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Packs that play clips.
    pub packs: Vec<ViewPack>,
    /// Clips.
    pub clips: Vec<ViewClip>,
    /// Packs that make a motion at strengths of emotions; they need no clip.
    pub emotions: Vec<ViewPack>,
    /// Packs that change faces.
    pub face_packs: Vec<ViewPack>,
    /// Pictures of faces.
    pub faces: Vec<ViewFace>,
}

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Packs without something to play, or the other way round.
    #[error("the page needs at least one pack and one clip, an emotion pack, or a face pack and a picture")]
    Empty,
    /// A pack is refused.
    #[error("{name}: {error}")]
    Pack {
        /// The pack.
        name: String,
        /// Why.
        error: LoadError,
    },
    /// A pack's skeleton is refused.
    #[error("{name}: {error}")]
    Rig {
        /// The pack.
        name: String,
        /// Why.
        error: RigError,
    },
    /// A picture cannot be shown.
    #[error("{name}: cannot be written as JPEG: {error}")]
    Picture {
        /// The picture.
        name: String,
        /// Why.
        error: String,
    },
    /// Landmarks are no face.
    #[error("{name}: the landmarks are no face")]
    Face {
        /// The picture.
        name: String,
    },
    /// A motion is longer than a page can hold.
    #[error("{name}: the motion has {frames:.0} frames, expected at most {most:.0}")]
    Long {
        /// The pack.
        name: String,
        /// Its frames.
        frames: f64,
        /// The most.
        most: f64,
    },
    /// A pack moves the face in a way that no picture follows.
    #[error("{name}: {error}")]
    Warp {
        /// The picture.
        name: String,
        /// Why.
        error: WarpError,
    },
    /// A clip cannot be put on a pack's skeleton.
    #[error(transparent)]
    Clip(#[from] PrepareError),
}

/// What the scripts read.
#[derive(Serialize)]
struct Data {
    wasm: String,
    packs: Vec<scene::PackData>,
    clips: Vec<Named>,
    /// `[packs][clips]`.
    scenes: Vec<Vec<scene::SceneData>>,
    /// Frames over which outputs are compared, and the strength there.
    checked: usize,
    strength: f32,
    emotions: Vec<emotion::EmotionData>,
    /// The joint that is plotted at first.
    joint: String,
    #[serde(rename = "facePacks")]
    face_packs: Vec<face::FacePackData>,
    faces: Vec<face::FaceData>,
    /// `[face packs][faces]`.
    #[serde(rename = "faceScenes")]
    face_scenes: Vec<Vec<face::FaceSceneData>>,
}

#[derive(Serialize)]
struct Named {
    name: String,
}

/// The page's HTML. `wasm` is [`WASM`], or another build of the same crate. `made`: who made it, with which command.
pub fn page(title: &str, made: &str, view: &View, wasm: &[u8]) -> Result<String, ViewError> {
    let half = |packs: &[ViewPack], of: usize| packs.is_empty() != (of == 0);
    if half(&view.packs, view.clips.len())
        || half(&view.face_packs, view.faces.len())
        || [&view.packs, &view.emotions, &view.face_packs].iter().all(|packs| packs.is_empty())
    {
        return Err(ViewError::Empty);
    }
    let mut data = Data {
        wasm: BASE64_STANDARD.encode(wasm),
        packs: Vec::new(),
        clips: view.clips.iter().map(|clip| Named { name: clip.name.clone() }).collect(),
        scenes: Vec::new(),
        checked: CHECKED,
        strength: STRENGTH,
        emotions: view.emotions.iter().map(emotion::data).collect::<Result<_, _>>()?,
        joint: String::new(),
        face_packs: Vec::new(),
        faces: view.faces.iter().map(face::data).collect::<Result<_, _>>()?,
        face_scenes: Vec::new(),
    };
    for pack in &view.packs {
        let player = scene::Player::new(pack)?;
        data.scenes.push(view.clips.iter().map(|clip| player.scene(clip)).collect::<Result<_, _>>()?);
        data.packs.push(player.data()?);
    }
    for pack in &view.face_packs {
        let player = face::FacePlayer::new(pack)?;
        data.face_scenes.push(view.faces.iter().map(|face| player.scene(face)).collect::<Result<_, _>>()?);
        data.face_packs.push(player.data()?);
    }
    let bodies = data.packs.iter().map(|pack| &pack.body);
    data.joint = scene::first_joint(bodies.chain(data.emotions.iter().map(|pack| &pack.body)).next());
    let json = serde_json::to_string(&data).unwrap_or_else(|error| unreachable!("plain data has no JSON: {error}"));
    // As a browser reads them, whatever line ends the sources were checked out with: the policy holds their hashes.
    let unix = |text: &str| text.replace("\r\n", "\n");
    let script = unix(&format!("\n\"use strict\";\n{}\n", SCRIPTS.join("\n")));
    let style = unix(&format!("\n{STYLE}\n"));
    let parts = [
        ("title", escape(title)),
        ("policy", policy(&script, &style)),
        ("style", style),
        ("made", escape(made)),
        ("data", inert(&json)),
        ("script", script),
    ];
    Ok(fill(PAGE, &parts.each_ref().map(|(mark, part)| (*mark, part.as_str()))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};
    use crate::models;

    /// Marks of the template, ends of elements, what opens a comment in a script.
    const HOSTILE: &str = "{{data}}{{script}}</script><!--<script><img src=x onerror=PWN=1>\"'&";

    #[test]
    fn hostile_names_stay_text() {
        let mut clip = walk(&Manner::NEUTRAL, 0.5, 60.0, 0.0, 1);
        clip.skeleton.joints[3].name = HOSTILE.to_owned();
        let map = crate::clip::JointMap::detect(&walk(&Manner::NEUTRAL, 0.5, 60.0, 0.0, 1).skeleton).unwrap();
        let source = Source::new(HOSTILE, clip, map);
        let shown = View {
            packs: vec![ViewPack { name: HOSTILE.to_owned(), file: models::weary(), look: None }],
            clips: vec![ViewClip { name: HOSTILE.to_owned(), source, target: None }],
            ..View::default()
        };
        let html = page(HOSTILE, HOSTILE, &shown, WASM).unwrap();
        // The data: no `<` at all, and it says what it was given.
        let (_, rest) = html.split_once("id=\"data\">").unwrap();
        let (data, rest) = rest.split_once("</script>").unwrap();
        assert!(!data.contains('<'));
        let read: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!([&read["packs"][0]["name"], &read["clips"][0]["name"]], [HOSTILE; 2]);
        // The data is there once; the script behind it is the page's own, the one that the policy names.
        assert_eq!(html.matches(data).count(), 1);
        let (_, rest) = rest.split_once("<script>").unwrap();
        let (script, rest) = rest.split_once("</script>").unwrap();
        assert!(script.starts_with("\n\"use strict\";\n") && !script.contains("PWN") && !rest.contains("<script"));
        let (_, style) = html.split_once("<style>").unwrap();
        let (style, _) = style.split_once("</style>").unwrap();
        assert!(html.contains(&format!("content=\"{}\"", policy(script, style))));
        // Nothing hostile is an element, wherever it stands.
        assert!(!html.contains("<img") && !html.contains("<!--"));
    }
}
