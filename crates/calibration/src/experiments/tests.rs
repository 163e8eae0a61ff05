use super::*;
use input::shipped::MEASUREMENTS;

const HEADER: &str = "task,infill_density_percent,infill_direction_deg,negative_mm,positive_mm,range_mm,failure_negative,repeats,date,note";

fn of(lines: &str) -> Result<Vec<Experiment>, Problems> {
    parse(&format!("{HEADER}\n{lines}\n"), "m.csv")
}

#[test]
fn the_published_bench_is_in_the_documented_form() {
    let file = MEASUREMENTS[0];
    let found = parse(file.text, file.file).unwrap();
    assert_eq!(found.len(), 44);
    assert_eq!(found.iter().filter_map(|line| line.range_mm).count(), 40);
    assert_eq!(found[2].range_mm, Some(8.6));
    let tasks = ["ket8", "ket12", "rj45", "usb"];
    assert_eq!(parse_known(file.text, file.file, &tasks), Ok(found));
}

#[test]
fn partial_data_are_data() {
    let found = of("ket8,10,0,,,7.6,3,,,\n\
                    ket8,10,10,-3.1,2.4,,,2,,\n\
                    ket8,10,20,,1.5,,,,,\n\
                    ket8,10,30,,,not measurable,,,,the pad tore\n\
                    ket8,15,0,-2.0,,4.0,,,,")
    .unwrap();
    let extents: Vec<_> = found.iter().map(Experiment::extent).collect();
    let range = |mm: f64| Some((mm, false));
    assert_eq!(extents, [range(7.6), range(5.5), Some((1.5, true)), None, range(4.0)]);
    assert_eq!((found[1].repeats, found[3].note.as_str(), found[0].line), (2, "the pad tore", 2));
    assert_eq!(of("ket8,20,0,-2.3,1.8,,,,,").unwrap()[0].range_mm, Some(4.1));
    assert_eq!(parse("", "m.csv"), Ok(vec![]));
    assert_eq!(of("").map(|found| found.len()), Ok(0));
}

#[test]
fn what_looks_wrong_is_told_with_line_and_column() {
    for (line, column, words) in [
        ("ket8,0.07,0,,,7,,,,", DENSITY_KEY, "in fractions, multiply by 100: 7.00 %"),
        ("ket8,20,0.52,,,7,,,,", DIRECTION_KEY, "0.52 rad is 29.8 degrees"),
        ("ket8,20,1.5708,,,7,,,,", DIRECTION_KEY, "1.5708 rad is 90.0 degrees"),
        ("ket8,20,0,,,0.0041,,,,", "range_mm", "looks like metres; give millimetres, as in 4.1"),
        ("ket8,20,0,,,7600,,,,", "range_mm", "micrometres; give millimetres, as in 7.6"),
        ("ket8,20,0,0.5,2.5,,,,,", "negative_mm", "excludes 0"),
        ("ket8,20,0,-2.5,-0.5,,,,,", "positive_mm", "excludes 0"),
        ("ket8,20,0,-2.5,0.5,4,,,,", "range_mm", "3.00 mm wide"),
        ("ket8,20,0,,,,,,,", "range_mm", "nothing was measured"),
        ("ket8,20,0,,,7,5,,,", "failure_negative", "4 (contact loss"),
        ("ket8,20,0,,,7,,0,,", "repeats", "whole number"),
        ("ket8,20,0,,,7,,,31.3.26,", "date", "2026-03-31"),
        ("ket8,20,0,-4,5,not measurable,,,,", "range_mm", "both ends are given"),
        (",20,0,,,7,,,,", "task", "name the task"),
        ("ket8,20,0,,,7", "", "has 6 cells"),
        ("ket8,20,0,,,7,,,,\nket8,20,0,,,6,,,,", "task", "line 2; give the mean"),
    ] {
        let problems = of(line).unwrap_err();
        let at = 1 + line.lines().count() as u64;
        let [problem] = &problems.0[..] else { panic!("{problems}") };
        assert!(problem.problem.contains(words), "{problems}");
        let place = format!("m.csv: line {at}: {column}");
        assert!(problems.to_string().starts_with(&place), "{problems}");
    }
    let both = of("ket8,0.2,0,,,7,,,,\nket8,20,x,,,7,,,,").unwrap_err();
    assert_eq!(both.0.len(), 2);
}

#[test]
fn a_quoted_cell_that_runs_over_the_line_is_an_error_where_it_opened() {
    let line =
        |note: &str| format!("ket8,20,0,,,7,,,,{note}\nket8,30,0,,,7,,,,\nket8,40,0,,,7,,,,");
    let runs_over = ["\"5 mm pad", "\"a \"\"b", "\"", "\"two\nlines\"", "\"a\r\nb\""];
    for note in runs_over {
        let said = of(&format!("# a \" comment\n{}", line(note))).unwrap_err().to_string();
        assert!(said.starts_with("m.csv: line 3: a quoted cell runs over"), "{note}: {said}");
    }
    let said = of(&format!("{}\nket8,50,0,,,7,,,,\"last", line(""))).unwrap_err().to_string();
    assert!(said.starts_with("m.csv: line 5: "), "{said}");
    for (cell, note) in [
        ("\"a, \"\"b\"\"\"", "a, \"b\""),
        ("5\" pad", "5\" pad"),
        ("\"\"", ""),
        ("\"a\"b\"", "ab\""),
    ] {
        let found = of(&line(cell)).unwrap();
        assert_eq!((found.len(), found[0].note.as_str()), (3, note), "{cell}");
    }
    // A file of an old spreadsheet: its lines end with a carriage return alone.
    let old = format!("{HEADER}\n{}\nket8,x,0,,,7,,,,", line("")).replace('\n', "\r");
    let said = parse(&old, "m.csv").unwrap_err().to_string();
    assert!(said.starts_with("m.csv: line 5: infill_density_percent"), "{said}");
}

#[test]
fn the_same_finger_on_two_days_is_two_measurements() {
    assert_eq!(of("ket8,20,0,,,7,,,2026-03-01,\nket8,20,0,,,6,,,2026-03-02,").unwrap().len(), 2);
}

#[test]
fn unknown_tasks_and_columns_are_told_with_the_nearest() {
    // Together with other problems of the same line.
    let text = format!("{HEADER}\nket08,0.2,0,,,7,,,,\n");
    let error = parse_known(&text, "m.csv", &["ket8", "usb"]).unwrap_err().to_string();
    for part in ["line 2: task: unknown task `ket08`", "did you mean `ket8`", "in fractions"] {
        assert!(error.contains(part), "{error}");
    }
    for (header, words) in [
        ("task,infill_density_percent,range_mm", "infill_direction_deg: is missing"),
        ("task,infill_density_percent,infill_direction_deg,rangemm", "did you mean `range_mm`"),
        ("task,infill_density_percent,infill_direction_deg,note,note", "twice"),
    ] {
        let error = parse(&format!("{header}\n"), "m.csv").unwrap_err().to_string();
        assert!(error.contains(words) && error.contains("line 1"), "{error}");
    }
}

#[test]
fn further_parameters_are_further_columns() {
    let text = "task,infill_density_percent,infill_direction_deg,range_mm,finger.rcc_mm\n\
                ket8,20,0,5,15\nket8,20,0,6,\n";
    let found = parse(text, "m.csv").unwrap();
    assert_eq!(found[0].design.get("finger.rcc_mm"), Some(15.0));
    assert_eq!(found[1].design.get("finger.rcc_mm"), None);
}

#[test]
fn a_line_is_added_and_the_others_stay_as_they_were() {
    let cells = |range: &str| {
        vec![
            ("task", "ket8".to_owned()),
            (DENSITY_KEY, "20".to_owned()),
            (DIRECTION_KEY, "0".to_owned()),
            ("range_mm", range.to_owned()),
            ("note", "a, b".to_owned()),
        ]
    };
    let new = appended("", "", &cells("7")).unwrap();
    assert!(new.starts_with("task,infill_density_percent,infill_direction_deg,negative_mm,"));
    assert_eq!(parse(&new, "m.csv").unwrap()[0].note, "a, b");
    let short = "task,infill_density_percent,infill_direction_deg,range_mm\nusb,10,0,4.70";
    let longer = appended(short, "", &cells("7")[..4]).unwrap();
    assert_eq!(longer, format!("{short}\nket8,20,0,7\n"));
    let wider = appended(&longer, "", &cells("6")).unwrap();
    let lines = "range_mm,note\nusb,10,0,4.70,\nket8,20,0,7,\nket8,20,0,6,\"a, b\"\n";
    assert!(wider.contains(lines), "{wider}");
}

#[test]
fn a_comment_line_keeps_the_file_of_a_task_and_is_no_line_of_the_table() {
    let head = "task,infill_density_percent,infill_direction_deg,range_mm\nmine,20,0,7\n";
    let cells = |key: &'static str, cell: &str| {
        let all = [("task", "mine"), (DENSITY_KEY, "20"), (DIRECTION_KEY, "9"), (key, cell)];
        all.map(|(column, cell)| (column, cell.to_owned()))
    };
    let old = own_task("mine", "my tasks/mine.toml") + head;
    let moved = appended(&old, &own_task("mine", "b.toml"), &cells("range_mm", "8")).unwrap();
    assert_eq!(moved, format!("{old}# task mine: b.toml\nmine,20,9,8\n"));
    assert_eq!(own_tasks(&moved)["mine"], "b.toml");
    assert_eq!(parse(&moved, "m.csv").unwrap().iter().map(|l| l.line).collect::<Vec<_>>(), [3, 5]);
    let error = parse(&moved.replace(",8", ",x"), "m.csv").unwrap_err().to_string();
    assert!(error.starts_with("m.csv: line 5: range_mm: "), "{error}");
    // A column more: the comments stay.
    let wider = appended(&moved, "", &cells("failure_negative", "3")).unwrap();
    assert_eq!(own_tasks(&wider), own_tasks(&moved));
    assert_eq!(own_tasks("\u{feff}# task a: a.toml,,,\r\n")["a"], "a.toml");
    assert_eq!(parse("# task a: a.toml\n\n", "m.csv"), Ok(vec![]));
}
