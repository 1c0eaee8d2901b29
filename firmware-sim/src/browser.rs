//! A page in headless Chromium, driven through two pipes: input as a person gives it, state read back.
//!
//! Chromium's debugging protocol is JSON texts that end with a zero byte; `--remote-debugging-pipe` reads them from descriptor 3 and
//! writes them to descriptor 4, so neither a port nor a driver is needed.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

/// What went wrong.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum BrowserError {
    /// It cannot be started, or the pipes broke.
    #[error("cannot talk to chromium: {0}")]
    #[diagnostic(help("run firmware-sim/setup.sh as root (Debian: installs chromium)"))]
    Io(#[from] std::io::Error),
    /// It refused a command.
    #[error("chromium refused {method}: {answer}")]
    Refused {
        /// The command.
        method: String,
        /// What it said.
        answer: String,
    },
}

/// A browser with one page. It ends when it is dropped.
#[derive(Debug)]
pub struct Browser {
    process: Child,
    to: File,
    from: BufReader<File>,
    session: String,
    last: u64,
    /// Uncaught errors and messages of level error, as the page made them.
    pub errors: Vec<String>,
    _folder: tempfile::TempDir,
}

impl Browser {
    /// Opens a file in a window of `width` by `height`; a `phone` has a touch screen and two pixels a unit.
    pub fn open(page: &Path, [width, height]: [u32; 2], phone: bool) -> Result<Self, BrowserError> {
        let folder = tempfile::tempdir()?;
        let [to, from] = ["to", "from"].map(|name| folder.path().join(name));
        let made = Command::new("mkfifo").args([&to, &from]).status()?;
        if !made.success() {
            return Err(std::io::Error::other("mkfifo made no pipes").into());
        }
        // A shell, because descriptors 3 and 4 cannot be set from here without unsafe code.
        let script = "exec chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --hide-scrollbars \
            --disable-background-networking --disable-component-update --disable-sync --disable-dev-shm-usage \
            --remote-debugging-pipe --user-data-dir=\"$0\" about:blank 3<\"$1\" 4>\"$2\"";
        let process = Command::new("sh")
            .args(["-c", script])
            .arg(folder.path().join("profile"))
            .args([&to, &from])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        // In the order in which the shell opens them: each waits for the other side.
        let (to, from) = (File::create(to)?, BufReader::new(File::open(from)?));
        let session = String::new();
        let mut browser = Self { process, to, from, session, last: 0, errors: Vec::new(), _folder: folder };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}))?;
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let attached = browser.call("Target.attachToTarget", attach)?;
        browser.session = attached["sessionId"].as_str().unwrap_or_default().to_owned();
        browser.call("Runtime.enable", json!({}))?;
        browser.call("Log.enable", json!({}))?;
        let scale = if phone { 2 } else { 1 };
        let size = json!({"width": width, "height": height, "deviceScaleFactor": scale, "mobile": phone});
        browser.call("Emulation.setDeviceMetricsOverride", size)?;
        browser.call("Emulation.setTouchEmulationEnabled", json!({"enabled": phone}))?;
        browser.call("Page.enable", json!({}))?;
        browser.call("Page.navigate", json!({"url": format!("file://{}", page.display())}))?;
        Ok(browser)
    }

    /// Sends a command and waits for its answer; what the page reports meanwhile is kept.
    pub fn call(&mut self, method: &str, params: Value) -> Result<Value, BrowserError> {
        self.last += 1;
        let mut message = json!({"id": self.last, "method": method, "params": params});
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.to.write_all(message.to_string().as_bytes())?;
        self.to.write_all(b"\0")?;
        loop {
            let mut text = Vec::new();
            if self.from.read_until(0, &mut text)? == 0 {
                return Err(std::io::Error::other("it has ended").into());
            }
            text.pop();
            let answer: Value = serde_json::from_slice(&text).unwrap_or_default();
            self.note(&answer);
            if answer["id"] == self.last {
                if answer["error"].is_null() {
                    return Ok(answer["result"].clone());
                }
                return Err(BrowserError::Refused { method: method.to_owned(), answer: answer["error"].to_string() });
            }
        }
    }

    fn note(&mut self, event: &Value) {
        let params = &event["params"];
        let bad = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => params["type"] == "error",
            Some("Log.entryAdded") => params["entry"]["level"] == "error",
            _ => false,
        };
        if bad {
            self.errors.push(params.to_string());
        }
    }

    /// The value of an expression on the page; promises are waited for.
    pub fn value(&mut self, expression: &str) -> Result<Value, BrowserError> {
        let params = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", params)?;
        if !answer["exceptionDetails"].is_null() {
            return Err(BrowserError::Refused { method: expression.to_owned(), answer: answer.to_string() });
        }
        Ok(answer["result"]["value"].clone())
    }

    /// Waits until an expression is true, at most a minute.
    pub fn wait(&mut self, expression: &str) -> Result<(), BrowserError> {
        let begin = std::time::Instant::now();
        while self.value(&format!("Boolean({expression})"))? != true {
            if begin.elapsed().as_secs() > 60 {
                return Err(BrowserError::Refused {
                    method: expression.to_owned(),
                    answer: "not within a minute".to_owned(),
                });
            }
            std::thread::sleep(std::time::Duration::from_millis(30));
        }
        Ok(())
    }

    /// Presses and releases a key.
    pub fn key(&mut self, key: &str) -> Result<(), BrowserError> {
        let code = match key {
            " " => json!({"key": " ", "code": "Space", "windowsVirtualKeyCode": 32}),
            "ArrowLeft" => json!({"key": key, "code": key, "windowsVirtualKeyCode": 37}),
            "ArrowRight" => json!({"key": key, "code": key, "windowsVirtualKeyCode": 39}),
            "Home" => json!({"key": key, "code": key, "windowsVirtualKeyCode": 36}),
            _ => json!({"key": key, "text": key}),
        };
        for kind in ["keyDown", "keyUp"] {
            let mut params = code.clone();
            params["type"] = json!(kind);
            self.call("Input.dispatchKeyEvent", params)?;
        }
        Ok(())
    }

    /// A mouse event at a point of the page.
    pub fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) -> Result<(), BrowserError> {
        let button = if kind == "mouseWheel" { "none" } else { "left" };
        let held = i32::from(kind != "mouseReleased" && kind != "mouseWheel");
        let params = json!({"type": kind, "x": x, "y": y, "button": button, "buttons": held, "clickCount": 1, "deltaX": 0, "deltaY": 240});
        self.call("Input.dispatchMouseEvent", params).map(drop)
    }

    /// Fingers on the screen, as they are now.
    pub fn touch(&mut self, kind: &str, points: &[[f64; 2]]) -> Result<(), BrowserError> {
        let points: Vec<Value> = points.iter().map(|[x, y]| json!({"x": x, "y": y})).collect();
        self.call("Input.dispatchTouchEvent", json!({"type": kind, "touchPoints": points})).map(drop)
    }

    /// A point of an element, as shares of its box; it is scrolled into view.
    pub fn point(&mut self, id: &str, [across, down]: [f64; 2]) -> Result<[f64; 2], BrowserError> {
        let expression = format!(
            "(() => {{ const e = document.getElementById({id:?}); e.scrollIntoView({{block: 'nearest'}}); const b = \
             e.getBoundingClientRect(); return [b.left + {across} * b.width, b.top + {down} * b.height]; }})()"
        );
        let at = self.value(&expression)?;
        Ok([0, 1].map(|k| at[k].as_f64().unwrap_or_default()))
    }

    /// Presses an element where a person would.
    pub fn click(&mut self, id: &str) -> Result<(), BrowserError> {
        let at = self.point(id, [0.5, 0.5])?;
        self.mouse("mousePressed", at)?;
        self.mouse("mouseReleased", at)
    }

    /// A picture of the window (PNG).
    pub fn screenshot(&mut self) -> Result<Vec<u8>, BrowserError> {
        let picture = self.call("Page.captureScreenshot", json!({"format": "png"}))?;
        Ok(BASE64_STANDARD.decode(picture["data"].as_str().unwrap_or_default()).unwrap_or_default())
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Best effort: it may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
