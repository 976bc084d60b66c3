//! The page in a browser: no errors, the animation runs in time with the plots, and something is seen.

#[path = "browser/chromium.rs"]
mod chromium;

use chromium::Browser;
use nalgebra::SVector;
use serde_json::Value;
use shapebot_dynamics::Robot;
use shapebot_report::{Recorder, Report, RobotPage, RunPage, Trace};

/// Runs in the page before its own script.
const WATCH: &str = include_str!("browser/watch.js");
/// Runs in the page after its own script, and logs what it found.
const PROBE: &str = include_str!("browser/probe.js");

/// Adds a robot with a run of two seconds along its first output.
fn add<R, const N: usize, const NX: usize, const NS: usize>(
    report: &mut Report,
    robot: &R,
    reach: f64,
) where
    R: Robot<f64, N, NX, NS>,
{
    let description = robot.description();
    let mut recorder = Recorder::new(robot);
    let mut trace = Trace::default();
    let time: Vec<f64> = (0..=100).map(|k| f64::from(k) / 50.0).collect();
    let jacobian = robot.output_jacobian_position().try_inverse().expect("invertible");
    for t in &time {
        let output =
            SVector::<f64, NX>::from_fn(|i, _| reach * t / 2.0 * (1.0 - 0.4 * i as f64 * t));
        let shape = SVector::<f64, NS>::from_element(0.05 * (3.0 * t).sin());
        let offset = robot.output(&SVector::zeros(), &shape);
        let q = R::join(&(jacobian * (output - offset)), &shape);
        recorder.push(&q, &output, &output);
        trace.desired.push(output.as_slice().to_vec());
        trace.actual.push(output.as_slice().to_vec());
        trace.shape.push(shape.as_slice().to_vec());
    }
    report.robots.push(RobotPage::from_description(description));
    report.runs.push(RunPage {
        title: format!("A run of {}", description.name),
        robot: description.name.to_owned(),
        panels: trace.panels(description),
        animation: Some(recorder.finish()),
        time,
        ..RunPage::default()
    });
}

fn page() -> String {
    let mut report = Report { title: "Test".to_owned(), ..Report::default() };
    let ballbot = shapebot_generated::ballbot3d::Ballbot3d::<f64>::default();
    add(&mut report, &ballbot, 1.0);
    let maze = shapebot_generated::marble_maze::MarbleMaze::<f64>::default();
    add(&mut report, &maze, 0.1);
    report.html().expect("a page")
}

/// What the probe found in the page.
fn probed(browser: &Browser, options: &[&str]) -> Value {
    let page = page().replacen("<head>", &format!("<head><script>{WATCH}</script>"), 1).replacen(
        "</body>",
        &format!("<script>{PROBE}</script></body>"),
        1,
    );
    let found = browser.listen(&page, options, "PROBE:");
    serde_json::from_str(&found).unwrap_or_else(|e| panic!("{e}: {found}"))
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap_or_else(|| panic!("no number `{name}` in {value}"))
}

fn assert_alive(found: &Value) {
    assert_eq!(found["errors"], serde_json::json!([]), "errors in the page");
    for run in found["runs"].as_array().expect("a list of runs") {
        let title = &run["title"];
        assert_eq!(number(run, "start"), 0.0, "{title}: where it begins");
        assert!(number(run, "played") > 0.05, "{title}: time does not advance: {run}");
        assert_eq!(run["pictureMoved"], true, "{title}: the picture stands still");
        assert_eq!(run["cursorMoved"], true, "{title}: the cursor stands still");
        assert_eq!(number(run, "afterPause"), number(run, "played"), "{title}: it runs on");
        assert!(number(run, "red") > 20.0, "{title}: no ball is seen: {run}");
        assert!(number(run, "colors") > 100.0, "{title}: the picture is blank: {run}");
        assert!(
            (number(run, "clicked") - 1.0).abs() < 0.02,
            "{title}: a click goes elsewhere: {run}"
        );
        assert_eq!(run["keyTurned"], true, "{title}: arrow keys do not turn the view");
        assert_eq!(run["keyPlayed"], true, "{title}: the space bar does not play");
        assert!(number(run, "plots") >= 3.0, "{title}: plots are missing: {run}");
    }
    assert_eq!(found["runs"].as_array().map(Vec::len), Some(2));
    assert_eq!(found["unlabelled"], serde_json::json!([]), "controls without a name");
}

#[test]
fn the_page_lives_with_webgl() {
    let Some(browser) = Browser::find() else { return };
    // A software renderer: test machines have no graphics card.
    let options = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
    let found = probed(&browser, &options);
    assert_alive(&found);
    assert_eq!(found["renderer"], "WebglRenderer");
}

#[test]
fn the_page_lives_without_webgl() {
    let Some(browser) = Browser::find() else { return };
    let found = probed(&browser, &["--disable-gpu", "--disable-3d-apis"]);
    assert_alive(&found);
    assert_eq!(found["renderer"], "PainterRenderer");
}

#[test]
fn a_screenshot_shows_the_ball() {
    let Some(browser) = Browser::find() else { return };
    let options = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
    let (width, pixels) = browser.screenshot(&page(), &options);
    assert_eq!(width, 1200);
    let first = pixels[0];
    let other = pixels.iter().filter(|&&pixel| pixel != first).count();
    assert!(other > pixels.len() / 20, "only {other} pixels differ from the first");
    // Nothing else on the page is of the ball's red: that of the lines has no blue.
    let red = |&[r, g, b]: &[u8; 3]| r > 120 && g < r / 2 && b < r / 2 && b > r / 8;
    let ball = pixels.iter().filter(|pixel| red(pixel)).count();
    assert!(ball > 100, "{ball} pixels of the ball");
}
