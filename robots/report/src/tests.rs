//! What a page must be: safe, small, the same every time, and written whole.

use crate::*;

/// Equations as LaTeX and certificate of a model's text.
pub(crate) fn toolchain(name: &str, text: &str) -> (String, String) {
    let model = shapebot_model_dsl::parse_bytes(name, text.as_bytes()).model.expect("a model");
    let (equations, certificate) = shapebot_codegen::derive::prove(&model).expect("equations");
    let latex = shapebot_codegen::equations::to_latex((&model, &equations, &certificate));
    (latex, certificate.to_text())
}

/// A run of `count` shown instants with `lines` lines in one panel.
fn run(title: &str, count: usize, lines: usize, bodies: usize) -> RunPage {
    // Nothing regular that a smaller encoding could use.
    let noise = |k: usize| ((k * 7919 % 104_729) as f64).sin();
    let series = (0..lines).map(|line| Series {
        label: format!("line {line}"),
        stroke: Stroke::Actual,
        color: line,
        values: (0..count).map(|k| noise(k + line * count)).collect(),
    });
    let pose = |k: usize| Pose {
        position: [noise(k), noise(k + 1), noise(k + 2)],
        rotation: [0.5, 0.5 + 1e-3 * noise(k), 0.5, 0.5],
    };
    let path = |stroke| Path { stroke, points: (0..count).map(|k| pose(k).position).collect() };
    RunPage {
        title: title.into(),
        robot: "robot".into(),
        notes: vec!["a note".into()],
        time: (0..count).map(|k| k as f64 / 50.0).collect(),
        panels: vec![Panel { title: "Panel".into(), unit: "m".into(), series: series.collect() }],
        animation: Some(Animation {
            frames: (0..count).map(|k| (0..bodies).map(|body| pose(k + body)).collect()).collect(),
            carrier: None,
            floor: 0.0,
            paths: vec![path(Stroke::Desired), path(Stroke::Planned), path(Stroke::Actual)],
        }),
        figures: vec![Figure { name: "RMSE".into(), ours: 0.01, paper: None, unit: "m".into() }],
    }
}

fn report(runs: Vec<RunPage>, bodies: usize) -> Report {
    let body = Body { name: "body".into(), shape: Shape::Sphere { radius: 0.1 } };
    Report {
        title: "Title".into(),
        robots: vec![RobotPage {
            name: "robot".into(),
            bodies: vec![body; bodies],
            ..RobotPage::default()
        }],
        runs,
        ..Report::default()
    }
}

#[test]
fn no_text_becomes_markup() {
    let evil = "</script><script>alert('x')</script><!--\"&'";
    let mut report = report(vec![run(evil, 3, 1, 1)], 1);
    report.title = evil.into();
    report.summary = evil.into();
    report.tables = vec![Table {
        title: evil.into(),
        note: evil.into(),
        columns: vec![evil.into()],
        rows: vec![Row { cells: vec![evil.into()], run: Some(0) }],
    }];
    report.runs[0].notes = vec![evil.into()];
    report.runs[0].figures[0].name = evil.into();
    report.runs[0].figures[0].unit = evil.into();
    report.runs[0].panels[0].title = evil.into();
    report.runs[0].panels[0].series[0].label = evil.into();
    report.robots[0].name = evil.into();
    report.runs[0].robot = evil.into();
    report.robots[0].summary = evil.into();
    report.robots[0].equations =
        format!("% {evil}\n\\begin{{equation}}\n{evil}\n\\end{{equation}}");
    report.robots[0].certificate = evil.into();
    report.robots[0].bodies[0].name = evil.into();
    report.robots[0].parameters = vec![Parameter {
        name: evil.into(),
        unit: evil.into(),
        docs: evil.into(),
        ..Parameter::default()
    }];
    report.robots[0].control = Some(Control {
        summary: evil.into(),
        figures: vec![DesignFigure { name: evil.into(), value: evil.into() }],
        ..Control::default()
    });
    let html = report.html().expect("a page");
    // The page's own elements are the only ones.
    assert_eq!(html.matches("<script").count(), 2);
    assert_eq!(html.matches("</script").count(), 2);
    assert_eq!(html.matches("<!--").count(), 0);
}

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let html = report(vec![run("run", 3, 1, 1)], 1).html().expect("a page");
    for reference in ["http:", "https:", "src=", "@import", "url("] {
        let places: Vec<&str> =
            html.split(reference).skip(1).map(|rest| &rest[..rest.len().min(40)]).collect();
        assert!(places.is_empty(), "`{reference}` stands before {places:?}");
    }
}

#[test]
fn the_same_report_gives_the_same_bytes() {
    let page =
        || report(vec![run("one", 100, 4, 3), run("two", 50, 2, 3)], 3).html().expect("a page");
    assert_eq!(page(), page());
}

/// Twenty runs of 15 s with 50 shown instants each second, 45 lines and ten bodies each.
#[test]
fn twenty_long_runs_fit() {
    let runs = (0..20).map(|k| run(&format!("run {k}"), 751, 45, 10)).collect();
    let html = report(runs, 10).html().expect("a page within the limit");
    assert!(html.len() < LIMIT, "{} bytes", html.len());
}

#[test]
fn a_page_beyond_the_limit_is_refused() {
    let runs = (0..20).map(|k| run(&format!("run {k}"), 751, 300, 1)).collect();
    let error = report(runs, 1).html().expect_err("too long");
    assert!(matches!(error, Error::TooLarge { bytes } if bytes > LIMIT), "{error}");
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let refuse = |change: &dyn Fn(&mut Report)| {
        let mut report = report(vec![run("run", 3, 1, 2)], 2);
        report.html().expect("sound before the change");
        change(&mut report);
        report.html().expect_err("refused")
    };
    let animation = |r: &mut Report| r.runs[0].animation.take().expect("an animation");
    let error = refuse(&|r| r.runs[0].panels[0].series[0].values.truncate(2));
    assert_eq!(error.to_string(), "run: Panel, line 0: 2 entries where 3 are needed");
    assert!(matches!(refuse(&|r| r.runs[0].time[2] = 0.0), Error::Time { .. }));
    assert!(matches!(refuse(&|r| r.runs[0].time.clear()), Error::Time { .. }));
    assert!(matches!(refuse(&|r| r.runs[0].robot = "x".into()), Error::UnknownRobot { .. }));
    assert!(matches!(refuse(&|r| r.robots[0].bodies.truncate(1)), Error::Length { .. }));
    assert!(matches!(refuse(&|r| r.runs[0].figures[0].ours = f64::NAN), Error::NotFinite { .. }));
    let change = |act: &dyn Fn(&mut Animation)| {
        refuse(&|r| {
            let mut shown = animation(r);
            act(&mut shown);
            r.runs[0].animation = Some(shown);
        })
    };
    assert!(matches!(change(&|a| a.frames.truncate(2)), Error::Length { .. }));
    assert!(matches!(change(&|a| a.carrier = Some(2)), Error::Length { .. }));
    assert!(matches!(change(&|a| a.frames[1][0].position[0] = f64::NAN), Error::NotFinite { .. }));
    assert!(matches!(change(&|a| a.paths[0].points.truncate(1)), Error::Length { .. }));
    let table = |cells: usize, run| Table {
        columns: vec!["column".into()],
        rows: vec![Row { cells: vec!["cell".into(); cells], run }],
        ..Table::default()
    };
    assert!(matches!(refuse(&|r| r.tables.push(table(2, None))), Error::Length { .. }));
    assert!(matches!(refuse(&|r| r.tables.push(table(1, Some(1)))), Error::UnknownRun { .. }));
}

#[test]
fn gaps_in_lines_are_no_error() {
    let mut report = report(vec![run("run", 3, 1, 1)], 1);
    report.runs[0].panels[0].series[0].values[1] = f64::NAN;
    report.html().expect("a page");
}

#[test]
fn a_file_is_replaced_whole_or_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("report.html");
    std::fs::write(&path, "before").expect("written");
    let names = || std::fs::read_dir(folder.path()).expect("a folder").count();

    let mut page = report(vec![run("run", 3, 1, 1)], 1);
    page.runs[0].time[1] = f64::NAN;
    page.write(&path).expect_err("refused");
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), "before");

    page.runs[0].time[1] = 0.02;
    page.write(&path).expect("written");
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), page.html().expect("a page"));
    assert_eq!(names(), 1);

    // A folder cannot be replaced by a file, and nothing is left beside it.
    let taken = folder.path().join("taken");
    std::fs::create_dir(&taken).expect("a folder");
    std::fs::write(taken.join("inside"), "").expect("written");
    assert!(matches!(page.write(&taken), Err(Error::File { .. })));
    assert_eq!(names(), 2);
}
