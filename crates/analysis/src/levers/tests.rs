use super::*;

fn lever(name: &str, at: [f64; 3], ends: [Option<f64>; 2]) -> Lever {
    let [low, value, high] = at;
    let [name, source] = [name, "made up"].map(str::to_owned);
    Lever { key: name.clone(), name, unit: "mm".to_owned(), value, low, high, source, ends }
}

fn of(infill: [f64; 2], levers: Vec<Lever>) -> Levers {
    let base = Base { range_mm: 4.0, taught_start_mm: 0.2 };
    let (task, design) = ("usb".to_owned(), Design::infill(10.0, 26.0));
    Levers { task, design, base, infill, levers, left_out: Vec::new(), windows: 9 }
}

#[test]
fn the_sentence_names_the_most_effective_lever_and_ignores_small_effects() {
    let tilt = || lever("tilt", [0.0, 5.0, 10.0], [Some(2.0), Some(4.9)]);
    let stroke = || lever("stroke", [-8.0, -10.0, -14.0], [Some(3.0), None]);
    let little = || lever("preload", [0.1, 0.3, 0.9], [Some(3.8), Some(4.2)]);
    let just = || lever("grip force", [2.5, 5.0, 10.0], [Some(4.0), Some(4.3)]);
    let about_zero = || lever("tilt", [-5.0, 0.0, 5.0], [Some(5.0), Some(3.0)]);
    let nothing = format!("Alone, nothing tried widens usb by 0.3 mm. {TUNE}");
    for (levers, said) in [
        (vec![about_zero()], "-5 mm of tilt widens usb by 1.0 mm."),
        (vec![tilt()], "5 mm more tilt widens usb by 0.9 mm."),
        (vec![little(), tilt()], "5 mm more tilt widens usb by 0.9 mm."),
        (vec![little(), just()], "5 mm more grip force widens usb by 0.3 mm."),
        (vec![stroke(), little()], &nothing),
        (Vec::new(), &nothing),
    ] {
        assert_eq!(of([4.0; 2], levers).sentence(), said);
    }
}

#[test]
fn the_uncertainty_names_the_smallest_ranges_over_what_a_user_does_not_set() {
    let friction = |ends| Lever {
        name: "friction".to_owned(),
        unit: String::new(),
        ..lever("task.friction.plug_socket", [0.1, 0.2, 0.4], ends)
    };
    let stiffness = lever("robot.stiffness_n_per_mm", [4.0, 10.0, 100.0], [None, Some(4.5)]);
    let tilt = lever("task.strategy.tilt_deg", [0.0, 5.0, 10.0], [Some(0.5), Some(1.0)]);
    let levers = |ends| of([4.0; 2], vec![friction(ends), tilt.clone(), stiffness.clone()]);
    let known = "0.0 mm with robot.stiffness_n_per_mm 4 mm";
    let said = levers([Some(2.0), Some(1.5)]).uncertainty().unwrap();
    assert_eq!(said, format!("{known}, 1.5 mm with friction 0.4"));
    assert_eq!(levers([Some(3.8), Some(4.9)]).uncertainty().as_deref(), Some(known));
    assert_eq!(of([4.0; 2], vec![tilt.clone()]).uncertainty(), None);
}

/// The space `codesign` is suggested only if it varies the best lever, the task has all of its parameters, and the
/// design sets none of them.
#[test]
fn the_sentence_suggests_the_space_that_varies_the_levers_together() {
    let without_effect = |key: &str| lever(key, [0.0, 5.0, 10.0], [Some(4.0); 2]);
    let mut tried = vec![lever("task.strategy.tilt_deg", [0.0, 5.0, 10.0], [Some(2.0), Some(4.9)])];
    tried.extend(
        [
            "task.strategy.phase.touch.preload_mm",
            "task.strategy.phase.side.move_mm.y",
            "task.grip.force_n",
            "task.strategy.phase.assembly.speed_mm_per_s",
        ]
        .map(without_effect),
    );
    let suggested = |levers: &Levers| levers.sentence().contains("--space codesign");
    let mut all = of([4.0; 2], tried.clone());
    assert!(suggested(&all), "{}", all.sentence());
    assert!(!suggested(&of([4.0; 2], tried[..4].to_vec())));
    let robot = lever("robot.flange_n_per_mm", [10.0, 20.0, 30.0], [Some(6.0), Some(4.0)]);
    let of_robot = of([4.0; 2], [&tried[..], &[robot]].concat());
    assert!(!suggested(&of_robot), "{}", of_robot.sentence());
    all.design = all.design.with("task.strategy.tilt_deg", 8.0);
    assert!(!suggested(&all), "{}", all.sentence());
}

#[test]
fn a_span_includes_the_baseline_and_ends_that_do_not_insert() {
    let base = of([4.0; 2], Vec::new()).base;
    for (ends, span_mm) in [
        ([Some(3.8), Some(4.1)], 0.3),
        ([Some(4.5), Some(5.0)], 1.0),
        ([None, Some(4.4)], 4.4),
        ([Some(4.0), Some(4.0)], 0.0),
    ] {
        assert_eq!(lever("tilt", [0.0, 1.0, 2.0], ends).span_mm(base), span_mm);
    }
}
