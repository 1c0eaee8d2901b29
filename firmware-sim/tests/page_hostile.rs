//! The page of `kinesic view` with every name hostile, in headless Chromium: text, and nothing that runs.

#[allow(dead_code, reason = "other visits use the rest")]
mod drawn;
#[path = "../../tests/tests/common/hostile.rs"]
mod hostile;
#[allow(dead_code, reason = "other visits use the rest")]
mod visit;

use hostile::Hostile;
use kinesic::model::ModelMeta;
use kinesic_firmware_sim::browser::Browser;
use kinesic_host::clip::JointMap;
use kinesic_host::emotion;
use kinesic_host::gait::{Manner, walk};
use kinesic_host::models;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::prepare::Source;
use kinesic_host::view::{self, View, ViewClip, ViewPack};
use serde_json::json;
use visit::state;

/// Marks of the template, ends of elements, what opens a comment in a script, and scripts that leave a trace.
const HOSTILE: &str = "{{data}}{{script}}</script></style></title><!--<script><script>window.PWN=1</script>\
                       <img src=x onerror=window.PWN=2>\"'&${window.PWN=3}";

fn renamed(file: &PackFile) -> ViewPack {
    let mut pack = Hostile::of(file);
    pack.name = HOSTILE.to_owned();
    pack.joints.iter_mut().for_each(|(joint, _)| *joint += HOSTILE);
    pack.models.iter_mut().for_each(|model| match model {
        ModelMeta::Translator(meta) => meta.style = HOSTILE,
        ModelMeta::Face(meta) => meta.attribute = HOSTILE,
        ModelMeta::Emotion(meta) => {
            meta.motion = HOSTILE;
            meta.attributes.iter_mut().flatten().for_each(|attribute| attribute.name = HOSTILE);
        }
        _ => {}
    });
    ViewPack { name: HOSTILE.to_owned(), file: PackFile::from_bytes(&pack.bytes()), look: None }
}

#[test]
#[ignore = "needs chromium: firmware-sim/setup.sh"]
fn hostile_names_are_text_on_a_page_that_works() {
    let clip = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.3, 3);
    let map = JointMap::detect(&clip.skeleton).unwrap();
    let source = Source::new(HOSTILE, clip, map);
    let (model, rig) = emotion::synthetic::model(2);
    let emotions = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
    let (smiles, faces) = drawn::faces();
    let shown = View {
        packs: vec![renamed(&models::weary()), renamed(&models::mechanics())],
        clips: vec![ViewClip { name: HOSTILE.to_owned(), source: source.clone(), target: Some(source) }],
        emotions: vec![renamed(&emotions)],
        face_packs: vec![renamed(&smiles)],
        faces: faces.map(|face| view::ViewFace { name: HOSTILE.to_owned(), ..face }).to_vec(),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    std::fs::write(&path, view::page(HOSTILE, HOSTILE, &shown, view::WASM).unwrap()).unwrap();
    let mut at = Browser::open(&path, [1400, 1000], false).unwrap();
    at.wait("typeof kinesic === 'object' && kinesic.compared").unwrap();
    // It plays, computes the host's bits, and nothing of the names has run or become an element.
    assert_eq!(state(&mut at)["errors"], json!([]));
    for each in state(&mut at)["bits"].as_array().unwrap() {
        assert_eq!(each["here"], each["host"], "{each}");
    }
    assert_eq!(at.value("window.PWN ?? null").unwrap(), json!(null));
    assert_eq!(
        at.value("document.images.length + document.querySelectorAll('iframe, object').length").unwrap(),
        json!(0)
    );
    assert_eq!(at.value("document.scripts.length").unwrap(), json!(2));
    assert_eq!(at.value("document.title").unwrap(), json!(HOSTILE));
    let names = at.value("kinesic.data.packs[0].name").unwrap();
    assert_eq!(names, json!(HOSTILE));
    assert!(at.errors.is_empty(), "{:?}", at.errors);
    // The policy: a script that got in would not run, and the style is the page's own.
    let script = "(() => { const s = document.createElement('script'); s.textContent = 'window.PWN=4'; document.body.append(s); \
                  document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=window.PWN=5>'); return window.PWN ?? null; })()";
    assert_eq!(at.value(script).unwrap(), json!(null));
    assert_eq!(at.value("fetch('https://example.org').then(() => 'sent', () => 'refused')").unwrap(), json!("refused"));
    assert_eq!(at.value("getComputedStyle(document.querySelector('main')).display !== ''").unwrap(), json!(true));
}
