//! Figures show the data inside their canvas, for any data.

use flexbody_figures::plots::{
    Barrier, BodyMotion, Connector, ConnectorKind, EnergyRun, Flight, Lapse, Motion, Scenery,
    convergence, energy, motion,
};
use flexbody_report::history::Column;
use flexbody_report::{History, HistoryRow};

/// Values of an attribute, in the order of the file.
fn attributes<'a>(svg: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    let parts = svg.split(&start).skip(1);
    parts
        .map(|part| part.split('"').next().expect("is valid"))
        .collect()
}

/// Every shape lies inside the picture, and every text begins inside.
fn assert_inside(svg: &str) {
    let view: Vec<f64> = attributes(svg, "viewBox")[0]
        .split(' ')
        .map(|n| n.parse().expect("is valid"))
        .collect();
    let (width, height) = (view[2], view[3]);
    let mut count = 0;
    let mut check = |text: &str, limit: f64| {
        let value: f64 = text.parse().expect("is valid");
        assert!((0.0..=limit).contains(&value), "{value} not in 0..{limit}");
        count += 1;
    };
    for list in attributes(svg, "points") {
        for pair in list.split_whitespace() {
            let (x, y) = pair.split_once(',').expect("is valid");
            check(x, width);
            check(y, height);
        }
    }
    for (names, limit) in [(["x", "cx"], width), (["y", "cy"], height)] {
        for name in names {
            for value in attributes(svg, name) {
                check(value, limit);
            }
        }
    }
    assert!(count > 20, "only {count} coordinates");
    assert!(!svg.contains("NaN") && !svg.contains("inf\""));
}

fn has_text(svg: &str, text: &str) -> bool {
    svg.lines().any(|line| line == text)
}

fn colored<'a>(svg: &'a str, tag: &str, color: &str) -> Vec<&'a str> {
    let tag = format!("<{tag} ");
    let lines = svg.lines().filter(|line| line.starts_with(&tag));
    lines.filter(|line| line.contains(color)).collect()
}

const BLUE: &str = "#0072B2";
const VERMILION: &str = "#D55E00";
const GREEN: &str = "#009E73";
const PURPLE: &str = "#CC79A7";

fn history(rows: impl Iterator<Item = [f64; 4]>) -> History {
    let row = |(iteration, [objective, infeasibility, optimality, barrier]): (usize, [f64; 4])| {
        HistoryRow {
            iteration,
            evaluations: iteration + 1,
            objective,
            infeasibility,
            optimality,
            barrier,
            step_norm: 0.0,
            dual_step: 1.0,
            primal_step: 1.0,
            regularisation: 0.0,
            line_search_trials: 1,
            phase: "normal".into(),
            steps: Some(158),
            refreshes: Some(1),
            design: Vec::new(),
            constraints: Vec::new(),
        }
    };
    History {
        objective: Column::new("range", Some("m")),
        variables: Vec::new(),
        constraints: Vec::new(),
        rows: rows.enumerate().map(row).collect(),
    }
}

#[test]
fn convergence_shows_four_curves_with_a_dot_an_iteration() {
    let rows = (0..12).map(|i| {
        let i = f64::from(i);
        let decay = 10_f64.powf(-0.8 * i);
        [
            850.0 - 300.0 * (-i).exp(),
            2.76 * decay,
            0.5 * decay,
            0.1 * decay,
        ]
    });
    let svg = convergence(&history(rows)).expect("is valid");
    assert_inside(&svg);
    for text in [
        "objective [m]",
        "range",
        "infeasibility",
        "optimality",
        "barrier parameter",
    ] {
        assert!(has_text(&svg, text), "{text}");
    }
    assert!(has_text(&svg, "iteration") && has_text(&svg, "1e-8"));
    for color in [BLUE, VERMILION, GREEN, PURPLE] {
        // A curve and its sample in the legend.
        assert_eq!(colored(&svg, "polyline", color).len(), 2, "{color}");
        assert_eq!(colored(&svg, "circle", color).len(), 12, "{color}");
    }
    assert!(!has_text(&svg, "zero or below the axis"));
}

#[test]
fn zeros_of_a_logarithmic_axis_are_marked_on_its_floor() {
    let rows = [
        [1.0, 1.0, 1.0, 0.1],
        [1.0, 0.0, 1e-3, 1e-2],
        [1.0, 0.0, 1e-6, 1e-3],
    ];
    let svg = convergence(&history(rows.into_iter())).expect("is valid");
    assert_inside(&svg);
    assert!(has_text(&svg, "zero or below the axis"));
    // Two zeros and the sample in the legend. One dot remains.
    assert_eq!(colored(&svg, "polygon", VERMILION).len(), 3);
    assert_eq!(colored(&svg, "circle", VERMILION).len(), 1);
}

#[test]
fn convergence_survives_one_row_gaps_and_huge_ranges() {
    let one = convergence(&history([[546.5, 2.76, 0.8, 0.1]].into_iter())).expect("is valid");
    assert_inside(&one);
    assert_eq!(colored(&one, "circle", BLUE).len(), 1);

    let nothing = [[f64::NAN, 0.0, f64::INFINITY, 0.0]];
    assert_inside(&convergence(&history(nothing.into_iter())).expect("is valid"));

    let huge = (0..300).map(|i| {
        let i = f64::from(i);
        let infeasibility = if i == 40.0 { f64::NAN } else { 10_f64.powf(-i) };
        [1e12 * i.sin(), infeasibility, 1e280, 1e-320]
    });
    let svg = convergence(&history(huge)).expect("is valid");
    assert_inside(&svg);
    assert_eq!(
        colored(&svg, "circle", BLUE).len(),
        0,
        "no dots on a long history"
    );
    // The sample in the legend, and a curve that a gap divides into two.
    assert_eq!(colored(&svg, "polyline", VERMILION).len(), 3);

    let error = convergence(&history(std::iter::empty())).expect_err("must be refused");
    assert_eq!(
        error.to_string(),
        "figure convergence: the history has no iterations"
    );
}

/// An arm about the origin with a stone at its end, thrown at 45°.
fn thrower(title: &str, speed: f64) -> Motion {
    let frames: Vec<f64> = (0..6).map(|i| 0.4 * f64::from(i)).collect();
    let tip = |angle: &f64| [10.0 * angle.cos(), 10.0 * angle.sin()];
    let square = |[x, y]: [f64; 2]| {
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
            .map(|(a, b)| [x + a, y + b])
            .to_vec()
    };
    let connector = |kind, to_ground, ends: &dyn Fn(&f64) -> [[f64; 2]; 2]| Connector {
        kind,
        to_ground,
        ends: frames.iter().map(ends).collect(),
    };
    Motion {
        title: title.into(),
        lapse: Lapse::Time,
        bodies: vec![
            BodyMotion {
                name: "arm".into(),
                patches: Vec::new(),
                depths: Vec::new(),
                outlines: frames.iter().map(|a| vec![[0.0, 0.0], tip(a)]).collect(),
            },
            BodyMotion {
                name: "stone".into(),
                patches: Vec::new(),
                depths: Vec::new(),
                outlines: frames.iter().map(tip).map(square).collect(),
            },
        ],
        connectors: vec![
            connector(ConnectorKind::Hinge, true, &|_| [[0.0, 0.0], [0.0, 0.0]]),
            connector(ConnectorKind::Slider, true, &|a| {
                [[*a, -3.0], [*a + 1.0, -3.0]]
            }),
            connector(ConnectorKind::Rod, false, &|a| [[0.0, 0.0], tip(a)]),
            connector(ConnectorKind::Spring, true, &|a| [[12.0, 12.0], tip(a)]),
            connector(ConnectorKind::Arm { body: 1 }, false, &|a| {
                [[1.0, 1.0], tip(a)]
            }),
        ],
        traces: vec![(0..=100).map(|i| tip(&(0.02 * f64::from(i)))).collect()],
        flight: Some(Flight {
            position: tip(&2.0),
            velocity: [speed, speed],
            gravity: 10.0,
        }),
        coloured: None,
    }
}

fn scenery() -> Scenery {
    Scenery {
        ground: Some(-4.0),
        barrier: Some(Barrier {
            distance: 60.0,
            top: 30.0,
        }),
        horizontal: "x [m]".into(),
        vertical: "y [m]".into(),
    }
}

#[test]
fn motion_shows_designs_flights_barrier_and_ground() {
    let designs = [
        thrower("initial design", 30.0),
        thrower("optimal design", 60.0),
    ];
    let svg = motion(&designs, &scenery()).expect("is valid");
    assert_inside(&svg);
    for text in [
        "initial design",
        "optimal design",
        "arm",
        "stone",
        "ground",
        "release",
    ] {
        assert!(has_text(&svg, text), "{text}");
    }
    assert!(has_text(&svg, "barrier at 60 m, top 30 m"));
    // Landing by hand: x = 10 cos 2 + v t, t = (v + sqrt(v² + 20 (10 sin 2 + 4))) / 10.
    for (design, speed) in designs.iter().zip([30.0_f64, 60.0]) {
        let height = 10.0 * 2.0_f64.sin() + 4.0;
        let time = (speed + (speed * speed + 20.0 * height).sqrt()) / 10.0;
        let distance = 10.0 * 2.0_f64.cos() + speed * time;
        let text = format!("{}: lands at {distance:.1} m", design.title);
        assert!(has_text(&svg, &text), "{text}");
    }
    // Stones: one polygon per frame and design, and a sample.
    assert_eq!(colored(&svg, "polygon", VERMILION).len(), 2 * 6 + 1);
    // Arms are lines: one per frame and design, the first flight and its sample.
    assert_eq!(colored(&svg, "polyline", BLUE).len(), 2 * 6 + 2);
    // A release in both designs, and a sample.
    assert_eq!(colored(&svg, "circle", "#000000").len(), 3);
}

#[test]
fn time_lapses_have_one_scale_in_both_directions() {
    let mut square = thrower("design", 30.0);
    let corners = vec![[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];
    square.bodies[1].outlines = vec![corners];
    for designs in [vec![square.clone()], vec![square.clone(), square]] {
        let svg = motion(&designs, &scenery()).expect("is valid");
        let shapes = colored(&svg, "polygon", VERMILION);
        for shape in &shapes[1..] {
            let points: Vec<(f64, f64)> = attributes(shape, "points")[0]
                .split_whitespace()
                .map(|pair| pair.split_once(',').expect("is valid"))
                .map(|(x, y)| (x.parse().expect("is valid"), y.parse().expect("is valid")))
                .collect();
            let (wide, high) = (points[1].0 - points[0].0, points[1].1 - points[2].1);
            assert!(
                wide > 500.0 && (wide - high).abs() <= 2.0,
                "{wide} × {high}"
            );
        }
    }
}

#[test]
fn motion_without_a_projectile_shows_only_the_time_lapse() {
    let mut design = thrower("", 30.0);
    design.flight = None;
    let bare = Scenery {
        ground: None,
        barrier: None,
        ..scenery()
    };
    let svg = motion(&[design.clone()], &bare).expect("is valid");
    assert_inside(&svg);
    assert_eq!(svg.matches("x [m]").count(), 1);
    assert!(!has_text(&svg, "ground") && !has_text(&svg, "release"));

    design.bodies.clear();
    for designs in [vec![design], Vec::new()] {
        let error = motion(&designs, &bare).expect_err("must be refused");
        assert_eq!(error.to_string(), "figure motion: no body has an outline");
    }
}

#[test]
fn flat_steep_and_broken_motions_stay_inside() {
    let mut flat = thrower("flat", 1.0);
    for body in &mut flat.bodies {
        body.outlines = vec![vec![[0.0, 0.0], [100.0, 0.0]]; 3];
    }
    flat.traces.clear();
    let mut steep = thrower("steep", 1.0);
    let flight = steep.flight.as_mut().expect("is valid");
    flight.velocity = [0.01, 500.0];
    let mut broken = thrower("broken", 1.0);
    broken.bodies[0].outlines[1][0] = [f64::NAN, 0.0];
    broken.traces[0][3] = [f64::INFINITY, 0.0];
    broken.flight.as_mut().expect("is valid").gravity = 0.0;
    let point = Motion {
        lapse: Lapse::Time,
        bodies: vec![BodyMotion {
            name: "a point".into(),
            patches: Vec::new(),
            depths: Vec::new(),
            outlines: vec![vec![[3.0, 3.0]]],
        }],
        connectors: Vec::new(),
        traces: Vec::new(),
        flight: None,
        coloured: None,
        title: "still".into(),
    };
    for design in [flat, steep, broken, point] {
        assert_inside(&motion(std::slice::from_ref(&design), &scenery()).expect("is valid"));
        assert_inside(&motion(&[design, thrower("b", 30.0)], &scenery()).expect("is valid"));
    }
}

fn swing(title: &str, drift: f64) -> EnergyRun {
    let time: Vec<f64> = (0..=2000).map(|i| 1e-3 * f64::from(i)).collect();
    EnergyRun {
        title: title.into(),
        kinetic: time
            .iter()
            .map(|t| 1e4 * (1.0 - (3.0 * t).cos()) + drift * t)
            .collect(),
        potential: time.iter().map(|t| 1e4 * (3.0 * t).cos() - 2e4).collect(),
        marks: Vec::new(),
        time,
    }
}

#[test]
fn energy_shows_kinetic_potential_total_and_drift() {
    let runs = [swing("initial design", 3e-3), swing("optimal design", 1e-3)];
    let svg = energy(&runs).expect("is valid");
    assert_inside(&svg);
    for text in [
        "kinetic",
        "potential",
        "total",
        "energy [J]",
        "total − start [J]",
        "time [s]",
    ] {
        assert!(has_text(&svg, text), "{text}");
    }
    assert!(has_text(&svg, "initial design") && has_text(&svg, "optimal design"));
    assert!(
        has_text(&svg, "2.0e-3") && has_text(&svg, "−20000"),
        "{svg}"
    );
    for color in [BLUE, VERMILION] {
        assert_eq!(colored(&svg, "polyline", color).len(), 3, "{color}");
    }
    assert_inside(&energy(&runs[..1]).expect("is valid"));
}

#[test]
fn energy_needs_complete_runs_and_takes_exact_ones() {
    let still = EnergyRun {
        title: String::new(),
        time: vec![0.0, 1.0],
        kinetic: vec![0.0, 0.0],
        potential: vec![0.0, 0.0],
        marks: Vec::new(),
    };
    assert_inside(&energy(std::slice::from_ref(&still)).expect("is valid"));
    let mut short = still;
    short.potential.pop();
    assert_eq!(
        energy(&[short]).expect_err("must be refused").to_string(),
        "figure energy: a simulation has not one energy for each instant"
    );
    assert_eq!(
        energy(&[]).expect_err("must be refused").to_string(),
        "figure energy: there is no simulation"
    );
}

#[test]
fn the_same_data_give_the_same_bytes() {
    let draw = || {
        let designs = [thrower("a", 30.0), thrower("b", 60.0)];
        let runs = [swing("a", 1e-3)];
        motion(&designs, &scenery()).expect("is valid") + &energy(&runs).expect("is valid")
    };
    assert_eq!(draw(), draw());
}
