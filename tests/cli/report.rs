//! `--report` and `optimize report`: one page that needs nothing else, in a browser where there is one.

use crate::program::{HAMMER, TREBUCHET, changed, expect, read, scratch, start};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

const PLATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/plate_patches.json");
const FLEXIBLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/problems/flexible/spin_up.json"
);

const SHELLS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/problems/flexible/double_plate_thin.json"
);

/// The data of a page.
fn data(page: &str) -> Value {
    let (_, rest) = page
        .split_once("id=\"data\">")
        .expect("the element with the data");
    let (text, _) = rest.split_once("</script>").expect("its end");
    serde_json::from_str(text).expect("JSON")
}

/// Simulates a problem into `out` with its page; gives the page's file.
fn simulated(at: &Path, problem: &str) -> PathBuf {
    let arguments = ["simulate", problem, "--output", "out", "--report"];
    expect(0, at, &arguments);
    at.join("out/report.html")
}

/// Nothing is loaded: no element names another file or address.
fn stands_alone(page: &str) {
    for word in [
        "src=",
        "href=",
        "url(",
        "@import",
        "fetch(",
        "XMLHttpRequest",
        "import(",
    ] {
        assert!(!page.contains(word), "{word}");
    }
}

#[test]
fn an_optimisation_and_its_record_give_the_same_page() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--report"]);
    let page = read(&at.path().join("out/report.html"));
    stands_alone(&page);
    let shown = data(&page);
    let titles = shown["stages"].as_array().expect("stages").iter();
    let titles: Vec<&str> = titles.filter_map(|own| own["title"].as_str()).collect();
    assert_eq!(titles, ["initial design", "optimal design"]);
    let record: Value =
        serde_json::from_str(&read(&at.path().join("out/optimum.json"))).expect("JSON");
    assert_eq!(shown["optimum"], record);
    for stage in shown["stages"].as_array().expect("stages") {
        let frames = stage["times"].as_array().expect("times").len();
        assert!((2..=240).contains(&frames), "{frames}");
        for body in stage["bodies"].as_array().expect("bodies") {
            let poses = body["shape"]["poses"].as_array().expect("poses");
            assert_eq!(poses.len(), frames);
        }
    }
    std::fs::remove_file(at.path().join("out/report.html")).expect("removed");
    expect(0, at.path(), &["report", "out"]);
    let again = data(&read(&at.path().join("out/report.html")));
    for key in ["stages", "charts", "optimum"] {
        assert_eq!(shown[key], again[key], "{key}");
    }
}

/// A page is written on request alone, and the request is refused where nothing says where to.
#[test]
fn no_page_is_written_that_nobody_asked_for() {
    let at = scratch();
    expect(0, at.path(), &["simulate", HAMMER, "--output", "out"]);
    assert!(!at.path().join("out/report.html").exists());
    for problem in [HAMMER, PLATE] {
        let ran = expect(2, at.path(), &["simulate", problem, "--report"]);
        assert!(ran.err.contains("--report without --output"), "{}", ran.err);
    }
    let ran = expect(2, at.path(), &["report", "nowhere"]);
    assert!(ran.err.contains("nowhere"), "{}", ran.err);
}

/// Texts of a file stay texts.
#[test]
fn no_text_of_a_problem_ends_its_element() {
    let at = scratch();
    let end = "</script><script>alert(1)</script><!--";
    let file = changed(at.path(), "own.json", |file| {
        file["description"] = end.into()
    });
    expect(
        0,
        at.path(),
        &["simulate", &file, "--output", "out", "--report"],
    );
    let page = read(&at.path().join("out/report.html"));
    assert!(!page.contains("alert(1)</script>"));
    assert_eq!(data(&page)["description"], end);
}

fn numbers(list: &Value) -> Vec<f64> {
    let list = list.as_array().expect("a list").iter();
    list.map(|x| x.as_f64().expect("a number")).collect()
}

/// The shape of a body that deforms is stored once, and its frames have few numbers: the displacements that follow from
/// them are those of the curves.
#[test]
fn a_body_of_few_shapes_is_stored_by_its_basis() {
    let at = scratch();
    let page = read(&simulated(at.path(), FLEXIBLE));
    let shown = data(&page);
    let bodies = shown["stages"][0]["bodies"].as_array().expect("bodies");
    let body = (bodies.iter().map(|body| &body["shape"])).find(|shape| shape["kind"] == "modal");
    let body = body.expect("a body with a basis");
    let basis: Vec<Vec<f64>> = (body["basis"].as_array().expect("a basis").iter())
        .map(numbers)
        .collect();
    let points = body["points"].as_array().expect("points").len();
    assert!(basis.iter().all(|shape| shape.len() == 3 * points));
    let frames = body["coordinates"].as_array().expect("coordinates");
    assert_eq!(
        frames.len(),
        shown["stages"][0]["times"].as_array().expect("times").len()
    );
    assert_eq!(frames.len(), body["poses"].as_array().expect("poses").len());
    // The tip: the last point of the first side. Its displacement is that of both sides' mean.
    let tip = |q: &[f64], k: usize| {
        let of = |j: usize| -> f64 { basis.iter().zip(q).map(|(n, q)| q * n[3 * j + k]).sum() };
        0.5 * (of(points / 2 - 1) + of(points / 2))
    };
    let charts = shown["charts"].as_array().expect("charts").iter();
    let mut charts = charts.filter(|own| own["title"] == "Displacement in the body's axes");
    let curves = charts.next().expect("displacements")["curves"].clone();
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m, x| f64::max(m, x.abs()));
    let drawn = (curves.as_array().expect("curves").iter()).map(|curve| {
        let points = curve["points"].as_array().expect("points").iter();
        largest(&mut points.map(|point| numbers(point)[1]))
    });
    let drawn = largest(&mut drawn.collect::<Vec<f64>>().into_iter());
    let shapes = frames.iter().map(numbers);
    let stored = largest(&mut shapes.flat_map(|q| [0, 1, 2].map(|k| tip(&q, k))));
    assert!(drawn > 0.0);
    // The frames are some of the instants.
    assert!((stored / drawn - 1.0).abs() < 1e-2, "{stored} {drawn}");
}

/// A structure loads from 0 to 1, and a body that deforms has the same faces in all frames.
#[test]
fn structures_and_bodies_that_deform_are_meshes() {
    let at = scratch();
    for (problem, frames) in [(PLATE, 2), (SHELLS, 12)] {
        let page = read(&simulated(at.path(), problem));
        assert!(page.len() < 3_000_000, "{problem}: {}", page.len());
        let shown = data(&page);
        let stages = shown["stages"].as_array().expect("stages");
        let last = stages.last().expect("a stage");
        let meshes = last["bodies"].as_array().expect("bodies").iter();
        let meshes: Vec<&Value> = meshes
            .map(|body| &body["shape"])
            .filter(|shape| shape["kind"] == "mesh")
            .collect();
        assert!(!meshes.is_empty(), "{problem}");
        for mesh in meshes {
            let places = mesh["places"].as_array().expect("places");
            assert!(places.len() >= frames, "{problem}: {}", places.len());
            let values = mesh["values"].as_array().expect("values");
            let faces = mesh["faces"].as_array().expect("faces");
            for (places, values) in places.iter().zip(values) {
                let [places, values] =
                    [places, values].map(|v| v.as_array().expect("a list").len());
                assert!(values == faces.len() || values == 0, "{problem}: {values}");
                assert_eq!(places % 3, 0);
                let largest = faces.iter().flat_map(|f| f.as_array().expect("a face"));
                let largest = largest.filter_map(Value::as_u64).max().expect("a corner");
                assert!((largest as usize) < places / 3, "{problem}");
            }
        }
    }
}

/// The forces of a page are those of the table of the simulation, at the joints.
#[test]
fn forces_are_the_reactions_of_the_table() {
    let at = scratch();
    let shown = data(&read(&simulated(at.path(), HAMMER)));
    let stage = &shown["stages"][0];
    let table = read(&at.path().join("out/simulation.csv"));
    let mut lines = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let names = lines.next().expect("names");
    let rows: Vec<Vec<f64>> = lines
        .map(|row| row.iter().map(|x| x.parse().expect("a number")).collect())
        .collect();
    let arrows = stage["arrows"].as_array().expect("arrows");
    assert_eq!(arrows.len(), 2);
    for arrow in arrows {
        let name = arrow["name"].as_str().expect("a name");
        let (joint, _) = name.split_once(", on ").expect("a joint and a body");
        let first = format!("{joint}: force x [N]");
        let column = names
            .iter()
            .position(|own| *own == first)
            .expect("a column");
        let times = stage["times"].as_array().expect("times");
        let forces = arrow["forces"].as_array().expect("forces");
        assert_eq!(times.len(), forces.len());
        for (t, force) in times.iter().zip(forces) {
            let t = t.as_f64().expect("a number");
            let row = rows.iter().find(|row| row[0] == t).expect("the instant");
            for k in 0..3 {
                let (exact, own) = (row[column + k], force[3 + k].as_f64().expect("a number"));
                assert!(
                    (own - exact).abs() <= 1e-5 * exact.abs() + 1e-300,
                    "{name} at {t}"
                );
            }
        }
    }
}

/// The page of a throw has the flight, from the place of the release to the ground; a box shows the whole of it.
#[test]
fn a_throw_shows_its_flight() {
    let at = scratch();
    let page = simulated(at.path(), TREBUCHET);
    let text = read(&page);
    let shown = data(&text);
    let stage = &shown["stages"][0];
    let flight = stage["flight"].as_array().expect("a flight");
    let (first, last) = (numbers(&flight[0]), numbers(&flight[flight.len() - 1]));
    let ground = stage["ground"].as_f64().expect("a ground");
    assert!(first[1] > ground + 1.0 && (last[1] - ground).abs() < 1e-3 * last[0]);
    // The largest range of the start, at one of the samples: 562.13 m.
    assert!((last[0] - 562.13).abs() < 0.5, "{last:?}");
    let Some(browser) = browser() else { return };
    let acts = ["", "document.getElementById('flight').click()"];
    let pictures = acts.map(|act| acted(browser, &page, "#t=0.5", act));
    assert!(pictures[0] != pictures[1]);
}

/// A run removes what it does not write: a page or a figure beside another record would be wrong.
#[test]
fn nothing_of_an_earlier_run_stays() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--report"]);
    std::fs::write(at.path().join("out/thickness.svg"), "of a plate").expect("written");
    std::fs::write(at.path().join("out/notes.txt"), "of the user").expect("written");
    expect(0, at.path(), &[HAMMER, "--output", "out"]);
    let exists = |name: &str| at.path().join("out").join(name).exists();
    assert!(!exists("report.html") && !exists("thickness.svg"));
    assert!(exists("notes.txt") && exists("motion.svg"));
}

/// A design that violates a constraint is no optimum, and says so in the table, as a warning and on the page.
#[test]
fn a_violated_constraint_is_shown() {
    let at = scratch();
    let limit = "/constraints/strong/upper=35";
    expect(0, at.path(), &["new", "arm", "--from", "arm"]);
    let arguments = ["arm.json", "--output", "out", "--report", "--set", limit];
    let few = ["--set", "/bodies/arm/beam/modes={\"bending_y\":1}"];
    let ran = expect(1, at.path(), &[&arguments[..], &few].concat());
    let row = ran.out.lines().find(|line| line.starts_with("  strong "));
    assert!(
        row.is_some_and(|row| row.contains("violated")),
        "{}",
        ran.out
    );
    assert!(ran.out.contains("\"strong\" is violated by"), "{}", ran.out);
    let page = at.path().join("out/report.html");
    let stages = data(&read(&page))["stages"].clone();
    assert_eq!(stages[1]["title"], "last design");
    let Some(browser) = browser() else { return };
    let (dom, said) = opened(browser, &page, "", &["--dump-dom"]);
    assert_eq!(said, "");
    assert!(
        dom.contains("violated by"),
        "{}",
        &dom[..dom.len().min(3000)]
    );
}

/// The page of a simulation has its functions and the problem, and fits the width of a phone.
#[test]
fn a_simulation_has_its_functions_and_fits_a_phone() {
    let Some(browser) = browser() else { return };
    let at = scratch();
    let page = simulated(at.path(), TREBUCHET);
    let act =
        "document.body.dataset.over = document.documentElement.scrollWidth - window.innerWidth;";
    let text = read(&page).replace("</body>", &format!("<script>{act}</script></body>"));
    std::fs::write(&page, text).expect("written");
    let (dom, said) = opened(browser, &page, "", &["--dump-dom", "--window-size=500,900"]);
    assert_eq!(said, "");
    for part in [
        "562.13",
        "clearance",
        "The problem as it was simulated",
        "made by optimize simulate",
    ] {
        assert!(dom.contains(part), "{part}");
    }
    let (_, over) = dom.split_once("data-over=\"").expect("a width");
    let over: f64 = over
        .split('"')
        .next()
        .and_then(|x| x.parse().ok())
        .expect("a number");
    assert!(over <= 0.0, "{over} pixels too wide");
}

/// The page of an optimisation is not replaced by that of a simulation.
#[test]
fn a_simulation_leaves_the_page_of_an_optimisation() {
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--report"]);
    let page = at.path().join("out/report.html");
    let before = read(&page);
    let ran = expect(
        2,
        at.path(),
        &["simulate", HAMMER, "--output", "out", "--report"],
    );
    assert!(ran.err.contains("another directory"), "{}", ran.err);
    assert!(read(&page) == before);
}

/// The resultants of a plate under pressure: the load is pressure times area, the supports balance it.
#[test]
fn resultants_of_a_structure_are_in_balance() {
    let at = scratch();
    let shown = data(&read(&simulated(at.path(), PLATE)));
    let stages = shown["stages"].as_array().expect("stages").iter();
    let mut with = stages.filter(|stage| !stage["arrows"].as_array().expect("arrows").is_empty());
    let arrows = with.next().expect("a load case")["arrows"].clone();
    let arrows = arrows.as_array().expect("arrows");
    assert_eq!(arrows.len(), 1 + 4);
    let mut sum = [0.0; 3];
    for arrow in arrows {
        let [none, full] = [0, 1].map(|k| numbers(&arrow["forces"][k]));
        assert_eq!(none[3..], [0.0; 3]);
        (0..3).for_each(|k| sum[k] += full[3 + k]);
    }
    let pressure = numbers(&arrows[0]["forces"][1]);
    let problem: Value = serde_json::from_str(&read(Path::new(PLATE))).expect("JSON");
    let plate = &problem["structures"]["plate"]["mesh"]["plate"];
    let side = |key: &str| plate[key].as_f64().expect("a number");
    let expected = 1e5 * side("length") * side("width");
    assert!(
        (pressure[5].abs() / expected - 1.0).abs() < 1e-5,
        "{pressure:?}"
    );
    assert!(sum.iter().all(|f| f.abs() < 1e-5 * expected), "{sum:?}");
}

/// While a run goes on its page is read again by itself and shows the convergence; at the end it is the report.
#[test]
fn a_run_can_be_watched() {
    let at = scratch();
    let page = at.path().join("out/report.html");
    let arguments = [
        TREBUCHET,
        "--output",
        "out",
        "--watch",
        "--set",
        "/simulation/tolerance=1e-13",
    ];
    let mut run = start(at.path(), &arguments);
    let begun = Instant::now();
    let text = loop {
        if let Ok(text) = std::fs::read_to_string(&page) {
            break text;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "no page");
        std::thread::sleep(Duration::from_millis(2));
    };
    assert!(text.contains("http-equiv=\"refresh\""));
    stands_alone(&text);
    let shown = data(&text);
    assert!(shown.get("optimum").is_none());
    assert_eq!(shown["charts"][0]["title"], "Objective");
    assert!(run.wait().expect("an end").success());
    let text = read(&page);
    assert!(!text.contains("http-equiv"));
    assert_eq!(data(&text)["optimum"]["status"], "converged");
    expect(2, at.path(), &[HAMMER, "--watch", "--starts", "2"]);
}

/// A program that shows pages, if there is one.
fn browser() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let found = names.into_iter().find(|name| {
        let ran = Command::new(name).arg("--version").output();
        ran.is_ok_and(|ran| ran.status.success())
    });
    if found.is_none() {
        println!("there is no browser: the pages are not opened");
    }
    found
}

/// What the browser has made of a page after its programs ran, and what it complained about.
fn opened(browser: &str, page: &Path, at: &str, more: &[&str]) -> (String, String) {
    let own = tempfile::tempdir().expect("a directory");
    let ran = Command::new(browser)
        .args([
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--hide-scrollbars",
        ])
        .args([
            "--enable-logging=stderr",
            "--v=0",
            "--virtual-time-budget=3000",
        ])
        .arg(format!("--user-data-dir={}", own.path().display()))
        .args(more)
        .arg(format!("file://{}{at}", page.display()))
        .output()
        .expect("a browser");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let complaints = text(&ran.stderr);
    let said = complaints.lines().filter(|line| line.contains("CONSOLE"));
    (text(&ran.stdout), said.collect())
}

/// The picture of a page after a program of the test has acted on it.
fn acted(browser: &str, page: &Path, at: &str, act: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a directory");
    let [own, picture] = ["acted.html", "picture.png"].map(|name| folder.path().join(name));
    let act = format!("<script>{act}</script></body>");
    std::fs::write(&own, read(page).replace("</body>", &act)).expect("written");
    let shot = format!("--screenshot={}", picture.display());
    let (_, said) = opened(browser, &own, at, &[&shot, "--window-size=1100,900"]);
    assert_eq!(said, "");
    std::fs::read(&picture).expect("a picture")
}

/// In a browser: no complaint, the program of the page runs to its end, tables and alternative texts are there, an instant
/// of the address shows another picture, and so do a dark scheme and the width of a phone.
#[test]
fn a_browser_shows_the_machine_at_an_instant() {
    let Some(browser) = browser() else { return };
    let at = scratch();
    expect(0, at.path(), &[HAMMER, "--output", "out", "--report"]);
    let page = at.path().join("out/report.html");
    let (dom, said) = opened(browser, &page, "#t=0.2", &["--dump-dom"]);
    assert_eq!(said, "");
    for part in [
        "data-ready=\"true\"",
        "id=\"verdict\"",
        "aria-label=",
        "t = 0.2000 s",
        "<table>",
    ] {
        assert!(
            dom.contains(part),
            "{part}: {}",
            &dom[..dom.len().min(3000)]
        );
    }
    let picture = |name: &str, at_time: &str, more: &[&str]| {
        let path = at.path().join(name);
        let shot = format!("--screenshot={}", path.display());
        let (_, said) = opened(browser, &page, at_time, &[&[shot.as_str()], more].concat());
        assert_eq!(said, "", "{name}");
        std::fs::read(&path).expect("a picture")
    };
    let wide = ["--window-size=1100,900"];
    // A browser on a busy machine may take its picture before the page is laid out: two alike are right.
    let steady = || {
        let mut last = picture("a.png", "#t=0", &wide);
        for _ in 0..4 {
            let next = picture("a.png", "#t=0", &wide);
            if next == last {
                break;
            }
            last = next;
        }
        last
    };
    let first = steady();
    assert!(
        first != picture("c.png", "#t=0.2", &wide),
        "another instant"
    );
    let dark = [
        "--window-size=1100,900",
        "--blink-settings=preferredColorScheme=0",
    ];
    assert!(first != picture("d.png", "#t=0", &dark), "dark");
    picture("e.png", "#t=0", &["--window-size=390,800"]);
    // What a user does: the box of the forces, keys that turn the view, the limits of colours.
    let text = read(&page);
    let changed = |act: &str| {
        let act = format!("<script>{act}</script></body>");
        std::fs::write(&page, text.replace("</body>", &act)).expect("written");
        assert!(first != picture("f.png", "#t=0", &wide), "{act}");
    };
    changed("document.getElementById('forces').click()");
    let key = "document.getElementById('scene0').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'}))";
    changed(key);
    std::fs::write(&page, &text).expect("written");
    assert!(first == steady(), "as before");
}

/// Limits of the colours that a user sets change the colours of a body that deforms.
#[test]
fn a_browser_takes_limits_of_colours() {
    let Some(browser) = browser() else { return };
    let at = scratch();
    let page = simulated(at.path(), PLATE);
    let pictures = ["", "1e8"].map(|value| {
        let field = "const own = document.getElementById('colour1');";
        let act = format!("{field} own.value = '{value}'; own.onchange();");
        acted(browser, &page, "", &act)
    });
    assert!(pictures[0] != pictures[1]);
}
