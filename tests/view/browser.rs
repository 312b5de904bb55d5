//! A headless Chromium that shows the page of a view.

use crate::client::PATIENCE;
use crate::devtools::DevTools;
use base64::Engine;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// A browser with one tab.
pub(crate) struct Browser {
    child: Child,
    tools: DevTools,
    _profile: TempDir,
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The process may have ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Browser {
    /// Starts a browser with a window of this size. If none is installed, returns `None`, or
    /// panics under `ABBE_REQUIRE_EXTERNAL`, which `tests/run --external` sets.
    pub(crate) fn start(size: (u32, u32), is_dark: bool) -> Option<Self> {
        let profile = tempfile::tempdir().unwrap();
        let started = NAMES.iter().find_map(|name| {
            Command::new(name)
                .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"])
                .args(["--disable-background-networking", "--disable-dev-shm-usage", "--no-proxy-server"])
                .args(["--force-color-profile=srgb", "--remote-debugging-port=0"])
                .arg(format!("--user-data-dir={}", profile.path().display()))
                .arg("about:blank")
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .ok()
        });
        assert!(
            started.is_some() || std::env::var_os("ABBE_REQUIRE_EXTERNAL").is_none(),
            "no browser is installed; tests/run --external installs chromium"
        );
        let mut child = started?;
        let mut said = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        let port = loop {
            line.clear();
            assert!(said.read_line(&mut line).unwrap() > 0, "the browser ended");
            if let Some(rest) = line.strip_prefix("DevTools listening on ws://127.0.0.1:") {
                break rest.split('/').next().unwrap().parse().unwrap();
            }
        };
        // The browser must be able to print more. The thread ends with the browser.
        std::thread::spawn(move || said.lines().map_while(Result::ok).for_each(drop));
        let mut tools = DevTools::connect(port);
        for domain in ["Page", "Runtime", "Network", "Log"] {
            tools.call(&format!("{domain}.enable"), &json!({}));
        }
        let mut browser = Self { child, tools, _profile: profile };
        browser.emulate(size, is_dark);
        Some(browser)
    }

    /// Changes the window's size and the colour scheme. A narrow window is a phone, with a touch
    /// screen.
    pub(crate) fn emulate(&mut self, (width, height): (u32, u32), is_dark: bool) {
        let is_phone = width < 600;
        let screen = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone});
        self.tools.call("Emulation.setDeviceMetricsOverride", &screen);
        self.tools.call("Emulation.setTouchEmulationEnabled", &json!({"enabled": is_phone}));
        let scheme = if is_dark { "dark" } else { "light" };
        let media = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        self.tools.call("Emulation.setEmulatedMedia", &media);
    }

    /// Makes pages see this number of processor cores.
    pub(crate) fn have_cores(&mut self, cores: u32) {
        self.tools.call("Emulation.setHardwareConcurrencyOverride", &json!({"hardwareConcurrency": cores}));
    }

    /// Returns the bytes of the process of the page that no other process shares, or `None` if the
    /// system does not report them.
    pub(crate) fn memory_of_page(&self) -> Option<u64> {
        let fields = |file: String| std::fs::read_to_string(file).ok();
        // The parent is the second field after the name of the program, which is in parentheses.
        let parent = |process: u32| -> Option<u32> {
            fields(format!("/proc/{process}/stat"))?.rsplit_once(") ")?.1.split(' ').nth(1)?.parse().ok()
        };
        let is_page = |process: u32| {
            let command = fields(format!("/proc/{process}/cmdline")).unwrap_or_default();
            let mut ancestors = std::iter::successors(Some(process), |&process| parent(process));
            command.contains("--type=renderer") && ancestors.any(|process| process == self.child.id())
        };
        let private = |process: u32| -> Option<u64> {
            let text = fields(format!("/proc/{process}/smaps_rollup"))?;
            let lines = text.lines().filter(|line| line.starts_with("Private_"));
            let kilobytes = lines.filter_map(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok());
            Some(1024 * kilobytes.sum::<u64>())
        };
        let processes = std::fs::read_dir("/proc").ok()?.flatten();
        let processes = processes.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
        // The browser keeps a small spare process.
        processes.filter(|&process| is_page(process)).filter_map(private).max()
    }

    pub(crate) fn open(&mut self, url: &str) {
        self.tools.call("Page.navigate", &json!({"url": url}));
    }

    /// Evaluates an expression on the page, and waits for its promise.
    pub(crate) fn run(&mut self, expression: &str) -> Value {
        let wanted = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let result = self.tools.call("Runtime.evaluate", &wanted);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        result["result"]["value"].clone()
    }

    /// Counts the workers that start from now on.
    pub(crate) fn watch_workers(&mut self) {
        let wanted = json!({"autoAttach": true, "waitForDebuggerOnStart": false, "flatten": true});
        self.tools.call("Target.setAutoAttach", &wanted);
    }

    /// Returns the number of running workers.
    pub(crate) fn workers(&mut self) -> usize {
        // The answer to any call comes after the events.
        self.run("0");
        let count = |name: &str| self.tools.events.iter().filter(|event| event["method"] == name).count();
        count("Target.attachedToTarget") - count("Target.detachedFromTarget")
    }

    /// Returns the names that a screen reader reads for all elements of a role.
    pub(crate) fn accessible(&mut self, role: &str) -> Vec<String> {
        let tree = self.tools.call("Accessibility.getFullAXTree", &json!({}));
        let nodes = tree["nodes"].as_array().unwrap().iter().filter(|node| node["role"]["value"] == role);
        nodes.map(|node| node["name"]["value"].as_str().unwrap_or_default().to_string()).collect()
    }

    /// Waits until an expression is true, also on another page to which the browser is on its way.
    pub(crate) fn wait(&mut self, expression: &str) {
        let start = Instant::now();
        // Before the page is loaded, its names are unknown.
        let guarded = format!("(() => {{ try {{ return Boolean({expression}); }} catch {{ return false; }} }})()");
        let wanted = json!({"expression": guarded, "returnByValue": true});
        // A page that the browser leaves answers with an error.
        let is_true = |found: Value| found["result"]["value"] == true;
        while !self.tools.try_call("Runtime.evaluate", &wanted).is_ok_and(is_true) {
            assert!(start.elapsed() < PATIENCE, "waited for {expression}: {:?}", self.complaints());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub(crate) fn mouse(&mut self, kind: &str, (x, y): (f64, f64), shift: bool) {
        let is_move = kind == "mouseMoved";
        let event = json!({"type": kind, "x": x, "y": y, "button": if is_move { "none" } else { "left" },
            "buttons": i32::from(kind != "mouseReleased"), "clickCount": i32::from(!is_move), "modifiers": if shift { 8 } else { 0 }});
        self.tools.call("Input.dispatchMouseEvent", &event);
    }

    /// Turns the wheel of the mouse. Negative values move nearer.
    pub(crate) fn wheel(&mut self, (x, y): (f64, f64), delta: f64) {
        let event = json!({"type": "mouseWheel", "x": x, "y": y, "deltaX": 0, "deltaY": delta});
        self.tools.call("Input.dispatchMouseEvent", &event);
    }

    /// Touches the screen with these fingers.
    pub(crate) fn touch(&mut self, kind: &str, fingers: &[(f64, f64)]) {
        let points: Vec<Value> =
            (0..).zip(fingers).map(|(id, (x, y)): (i32, _)| json!({"x": x, "y": y, "id": id})).collect();
        self.tools.call("Input.dispatchTouchEvent", &json!({"type": kind, "touchPoints": points}));
    }

    /// Saves downloads in a folder.
    pub(crate) fn download_to(&mut self, folder: &Path) {
        let wanted = json!({"behavior": "allow", "downloadPath": folder});
        self.tools.call("Browser.setDownloadBehavior", &wanted);
    }

    /// Moves the mouse without a pressed button.
    pub(crate) fn hover(&mut self, (x, y): (f64, f64)) {
        self.tools.call("Input.dispatchMouseEvent", &json!({"type": "mouseMoved", "x": x, "y": y}));
    }

    /// Presses a key. `text` is what the key types, or empty.
    pub(crate) fn key(&mut self, key: &str, text: &str) {
        let down = if text.is_empty() { "rawKeyDown" } else { "keyDown" };
        self.tools.call("Input.dispatchKeyEvent", &json!({"type": down, "key": key, "text": text}));
        self.tools.call("Input.dispatchKeyEvent", &json!({"type": "keyUp", "key": key}));
    }

    /// Saves a screenshot below the folder of the environment variable `ABBE_SCREENSHOTS`.
    pub(crate) fn screenshot(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("ABBE_SCREENSHOTS") else { return };
        let shot = self.tools.call("Page.captureScreenshot", &json!({}));
        let bytes = base64::engine::general_purpose::STANDARD.decode(shot["data"].as_str().unwrap()).unwrap();
        std::fs::write(PathBuf::from(folder).join(name), bytes).unwrap();
    }

    /// Forgets the messages and requests so far.
    pub(crate) fn forget(&mut self) {
        self.tools.events.clear();
    }

    /// Returns the messages of the console, the exceptions of scripts, and the requests to other
    /// servers.
    pub(crate) fn complaints(&self) -> Vec<String> {
        let of = |event: &Value| {
            let parameters = &event["params"];
            match event["method"].as_str()? {
                "Runtime.exceptionThrown" | "Runtime.consoleAPICalled" | "Log.entryAdded" => {
                    // Browsers ask for an icon by themselves. Only the tests read the canvas.
                    let text = parameters.to_string();
                    let is_own = text.contains("favicon.ico") || text.contains("willReadFrequently");
                    (!is_own).then_some(text)
                }
                "Network.requestWillBeSent" => {
                    let url = parameters["request"]["url"].as_str()?;
                    let is_own = ["http://127.0.0.1:", "blob:http://127.0.0.1:", "data:image/", "about:"]
                        .iter()
                        .any(|own| url.starts_with(own));
                    (!is_own).then(|| url.to_string())
                }
                _ => None,
            }
        };
        self.tools.events.iter().filter_map(of).collect()
    }
}
