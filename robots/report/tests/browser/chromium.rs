//! A headless browser.

use std::fs::File;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Names under which Chromium is installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Patience with a busy machine.
const PATIENCE: Duration = Duration::from_secs(240);

/// One browser at a time: several starve each other.
static TURN: Mutex<()> = Mutex::new(());

/// A browser, with a folder of its own.
pub(crate) struct Browser {
    _turn: MutexGuard<'static, ()>,
    program: PathBuf,
    folder: TempDir,
}

impl Browser {
    /// The browser of this machine. `None`, after a line that says so, where there is none.
    ///
    /// # Panics
    ///
    /// If there is none although `SHAPEBOT_REQUIRE` wants `chromium`.
    pub(crate) fn find() -> Option<Self> {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
        let places = NAMES.iter().flat_map(|name| folders.iter().map(move |f| f.join(name)));
        let Some(program) = places.into_iter().find(|place| place.is_file()) else {
            skip("chromium", "the page is opened in Chromium, which is not here");
            return None;
        };
        // A test that failed has ended its browser.
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        Some(Self { _turn: turn, program, folder: TempDir::new().expect("a folder") })
    }

    /// Opens a page and waits until its script logs `words`; returns what follows them up to `;END`.
    pub(crate) fn listen(&self, page: &str, options: &[&str], words: &str) -> String {
        // With a debugging port the browser stays open.
        let actions = ["--remote-debugging-port=0", "--enable-logging=stderr"];
        let heard = || {
            let log = self.complaints();
            let rest = log.split(words).nth(1)?;
            Some(rest.split_once(";END")?.0.to_owned())
        };
        let mut child = self.open(page, options, &actions);
        let found = wait(heard);
        let _ = child.kill();
        let _ = child.wait();
        found.unwrap_or_else(|| panic!("the page does not say `{words}`: {}", self.complaints()))
    }

    /// A picture of the top of a page: width, and pixels as red, green, blue.
    pub(crate) fn screenshot(&self, page: &str, options: &[&str]) -> (usize, Vec<[u8; 3]>) {
        let picture = self.folder.path().join("picture.png");
        let to = format!("--screenshot={}", picture.display());
        let size = "--window-size=1200,1400";
        // A busy machine must not take it before the renderer has shown its first picture.
        let whole = "--run-all-compositor-stages-before-draw";
        let actions = [to.as_str(), size, whole, "--hide-scrollbars", "--virtual-time-budget=5000"];
        let mut child = self.open(page, options, &actions);
        let ended = wait(|| child.try_wait().expect("a child"));
        let _ = child.kill();
        assert!(ended.is_some(), "the browser does not end: {}", self.complaints());
        let file = File::open(&picture).unwrap_or_else(|e| panic!("{e}: {}", self.complaints()));
        let mut reader =
            png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
        let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut bytes).expect("a picture");
        let samples = info.color_type.samples();
        let pixels = bytes[..info.buffer_size()].chunks_exact(samples);
        (info.width as usize, pixels.map(|p| [p[0], p[1], p[2]]).collect())
    }

    /// What the browser wrote to its standard error.
    fn complaints(&self) -> String {
        let bytes = std::fs::read(self.folder.path().join("log")).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    fn open(&self, page: &str, options: &[&str], actions: &[&str]) -> Child {
        let folder = self.folder.path();
        let file = folder.join("page.html");
        std::fs::write(&file, page).expect("written");
        Command::new(&self.program)
            // A test may run as root, where the sandbox does not start.
            .args(["--headless", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run"])
            .arg(format!("--user-data-dir={}", folder.join("profile").display()))
            .args(options)
            .args(actions)
            .arg(format!("file://{}", file.display()))
            .stdout(Stdio::null())
            .stderr(File::create(folder.join("log")).expect("a file"))
            .spawn()
            .expect("the browser starts")
    }
}

/// Until there is something; `None` when patience ends.
fn wait<T>(mut look: impl FnMut() -> Option<T>) -> Option<T> {
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        let found = look();
        if found.is_some() {
            return found;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    None
}

/// Says that a test is skipped and why, past the capture of the test harness.
fn skip(name: &str, why: &str) {
    let required = std::env::var("SHAPEBOT_REQUIRE").unwrap_or_default();
    let listed = |word: &str| word.trim() == name || word.trim() == "all";
    assert!(!required.split(',').any(listed), "SHAPEBOT_REQUIRE wants `{name}`: {why}");
    let _ = writeln!(std::io::stderr(), "skipped ({name}): {why}");
}
