//! What visits of the page have in common. `KINESIC_SHOTS=FOLDER` keeps the pictures that are taken on the way.

use std::path::PathBuf;

use kinesic_firmware_sim::browser::Browser;
use serde_json::{Value, json};

/// The page reads itself back.
pub fn state(browser: &mut Browser) -> Value {
    browser.value("kinesic.state()").unwrap()
}

/// Sets a slider or a list as a person does, and waits until the results are made again.
pub fn set(browser: &mut Browser, id: &str, value: &str, event: &str) {
    let script = format!(
        "(() => {{ const e = document.getElementById({id:?}); e.value = {value:?}; e.dispatchEvent(new Event({event:?}, {{bubbles: true}})); }})()"
    );
    browser.value(&script).unwrap();
    settle(browser);
}

pub fn settle(browser: &mut Browser) {
    browser.wait("kinesic.results.every((r) => !r || r.done === r.frames && !r.changed)").unwrap();
}

/// The pose that a figure shows.
pub fn pose(state: &Value, figure: usize) -> Vec<f64> {
    state["figures"][figure]["pose"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// Largest difference of a number of two poses.
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

pub fn shot(browser: &mut Browser, name: &str) {
    let picture = browser.screenshot().unwrap();
    assert!(picture.len() > 10_000);
    if let Some(folder) = std::env::var_os("KINESIC_SHOTS") {
        std::fs::write(PathBuf::from(folder).join(name), picture).unwrap();
    }
}

pub fn dark(browser: &mut Browser) {
    let dark = json!({"features": [{"name": "prefers-color-scheme", "value": "dark"}]});
    browser.call("Emulation.setEmulatedMedia", dark).unwrap();
}

/// Nothing has to be scrolled sideways.
pub fn fits(browser: &mut Browser) {
    let [wide, window] =
        ["document.documentElement.scrollWidth", "innerWidth"].map(|e| browser.value(e).unwrap().as_f64().unwrap());
    assert!(wide <= window, "the page is {wide} wide in a window of {window}");
}

/// Everything that can be turned has a name, and nothing went wrong.
pub fn well(browser: &mut Browser) {
    let nameless = browser.value("[...document.querySelectorAll('button, input, select, canvas')].filter((e) => !(e.getAttribute('aria-label') || e.labels?.length || e.textContent.trim())).map((e) => e.id)").unwrap();
    assert_eq!(nameless.as_array().unwrap().len(), 0, "{nameless}");
    assert!(browser.errors.is_empty() && state(browser)["errors"] == json!([]), "{:?}", browser.errors);
}
