//! `optimize ask-tell` as another program sees it.

use crate::common::{command, run};
use ask_tell::OptimizerKind;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

/// A running program; ended when dropped.
struct Talk {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Talk {
    fn begin(header: &Value) -> Self {
        let mut talk = Self::silent();
        talk.say(&header.to_string());
        talk
    }

    fn silent() -> Self {
        let mut command = command(&["ask-tell"]);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (input, output) = (child.stdin.take(), BufReader::new(child.stdout.take().unwrap()));
        Talk { child, input, output }
    }

    fn say(&mut self, line: &str) {
        writeln!(self.input.as_mut().unwrap(), "{line}").unwrap();
    }

    /// Waits for the answer before anything else is said: answers must not stay in a buffer.
    fn raw(&mut self, line: &str) -> String {
        self.say(line);
        let mut answer = String::new();
        self.output.read_line(&mut answer).unwrap();
        answer
    }

    fn answer(&mut self, line: &Value) -> Value {
        serde_json::from_str(&self.raw(&line.to_string())).unwrap()
    }

    fn ask(&mut self, n: usize) -> Vec<Value> {
        self.answer(&json!({"ask": n}))["asked"].as_array().unwrap().clone()
    }

    fn error(&mut self, line: &str, part: &str) {
        let answer: Value = serde_json::from_str(&self.raw(line)).unwrap();
        let text = answer["error"].as_str().unwrap_or_else(|| panic!("{line}: {answer}"));
        assert!(text.contains(part), "{line}: {text}");
        assert_eq!(answer.as_object().unwrap().len(), 1);
    }
}

impl Drop for Talk {
    fn drop(&mut self) {
        drop(self.input.take());
        let status = self.child.wait().unwrap();
        assert!(status.success() || std::thread::panicking());
    }
}

fn header(optimizer: &str, direction: &str, batch: Option<usize>) -> Value {
    let parameters = json!([
        {"name": "x", "low": -5, "high": 5},
        {"name": "n", "low": 1, "high": 9, "step": 2},
    ]);
    json!({"parameters": parameters, "optimizer": optimizer, "seed": 1, "direction": direction,
           "batch": batch})
}

fn bowl(point: &Value) -> f64 {
    let value = |name: &str| point["values"][name].as_f64().unwrap();
    (value("x") - 1.0).powi(2) + (value("n") - 7.0).powi(2)
}

fn told(points: &[Value], sign: f64) -> Value {
    let one = |p: &Value| json!({"id": p["id"], "value": sign * bowl(p)});
    json!({"tell": points.iter().map(one).collect::<Vec<_>>()})
}

#[test]
fn every_optimizer_asks_distinct_points_within_the_bounds_in_both_directions_alike() {
    for name in OptimizerKind::all().map(OptimizerKind::name) {
        let mut down = Talk::begin(&header(name, "minimize", None));
        let mut up = Talk::begin(&header(name, "maximize", None));
        let mut seen = Vec::new();
        for round in 0..8 {
            let points = down.ask(4);
            assert_eq!(points, up.ask(4), "{name}");
            for (i, point) in points.iter().enumerate() {
                assert_eq!(point["id"], json!(4 * round + i));
                assert!((-5.0..=5.0).contains(&point["values"]["x"].as_f64().unwrap()));
                let n = point["values"]["n"].as_f64().unwrap();
                assert!([1.0, 3.0, 5.0, 7.0, 9.0].contains(&n));
                assert!(!seen.contains(&point["values"]), "{name}: {point}");
                seen.push(point["values"].clone());
            }
            let (low, high) = (down.answer(&told(&points, 1.0)), up.answer(&told(&points, -1.0)));
            assert_eq!((&low["told"], &low["stop"]), (&json!(4), &Value::Null), "{name}");
            assert_eq!(low["best"]["id"], high["best"]["id"], "{name}");
            assert_eq!(low["best"]["value"].as_f64(), high["best"]["value"].as_f64().map(|v| -v));
        }
    }
}

#[test]
fn a_batch_may_be_asked_and_told_in_any_parts() {
    let mut whole = Talk::begin(&header("cma-es", "minimize", Some(5)));
    let mut parts = Talk::begin(&header("cma-es", "minimize", Some(5)));
    for _ in 0..6 {
        let points = whole.ask(9);
        assert_eq!(points.len(), 5, "a batch at most");
        let mut asked = parts.ask(2);
        // One value is told before the rest of its batch is asked.
        parts.answer(&told(&asked[1..2], 1.0));
        asked.extend(parts.ask(1));
        asked.extend(parts.ask(7));
        assert_eq!(asked, points);
        parts.error(r#"{"ask":1}"#, "tell the values of ids");
        let last = parts.answer(&told(&[4, 2, 0, 3].map(|i| asked[i].clone()), 1.0));
        assert_eq!(last["best"], whole.answer(&told(&points, 1.0))["best"]);
    }
}

#[test]
fn failed_evaluations_are_told_as_null() {
    let mut talk = Talk::begin(&header("gp", "minimize", None));
    let points = talk.ask(3);
    let nothing = talk.answer(&json!({"tell": [{"id": 0, "value": null}]}));
    assert_eq!(nothing, json!({"told": 1, "best": null, "stop": null}));
    let one = talk.answer(&json!({"tell": [{"id": 2, "value": 8}, {"id": 1, "value": null}]}));
    assert_eq!(one["best"], json!({"id": 2, "values": points[2]["values"], "value": 8.0}));
    assert_eq!(talk.ask(2).len(), 2);
}

#[test]
fn a_small_space_is_exhausted_and_says_so() {
    let mut header = header("random", "maximize", None);
    header["parameters"] = json!([{"name": "n", "low": 0.1, "high": 0.3, "step": 0.1}]);
    let mut talk = Talk::begin(&header);
    let points = talk.ask(5);
    let mut values: Vec<f64> = points.iter().map(|p| p["values"]["n"].as_f64().unwrap()).collect();
    values.sort_by(f64::total_cmp);
    assert_eq!(values, [0.1, 0.2, 0.3]);
    let tell = |id: u64| json!({"tell": [{"id": id, "value": 1}]});
    assert!(talk.answer(&tell(1))["stop"].is_null() && talk.answer(&tell(2))["stop"].is_null());
    let last = talk.answer(&tell(0));
    assert_eq!((&last["stop"], &last["best"]["id"]), (&json!("space_exhausted"), &json!(0)));
    assert_eq!(talk.ask(5), Vec::<Value>::new());
}

#[test]
fn bad_lines_are_answered_and_change_nothing() {
    let mut talk = Talk::begin(&header("cma-es", "minimize", None));
    let mut quiet = Talk::begin(&header("cma-es", "minimize", None));
    talk.error(r#"{"tell":[{"id":0,"value":1}]}"#, "id 0 was not asked");
    assert_eq!(talk.ask(4), quiet.ask(4));
    for (line, part) in [
        ("", "not valid JSON"),
        ("{\"ask\":1", "not valid JSON"),
        ("[1]", "unknown message"),
        ("{\"aks\":1}", "unknown message"),
        (r#"{"ask":-1}"#, "`ask`"),
        (r#"{"ask":1.5}"#, "`ask`"),
        (r#"{"ask":1,"more":2}"#, "unknown field `more`"),
        (r#"{"ask":1}"#, "tell the values of ids 0, 1, 2, 3 first"),
        (r#"{"ask":10001}"#, "10000"),
        (r#"{"tell":[{"id":0,"value":1},{"id":9,"value":1}]}"#, "id 9 was not asked"),
        (r#"{"tell":[{"id":0,"value":1},{"id":0,"value":1}]}"#, "id 0 is told twice"),
        (r#"{"tell":[{"id":0}]}"#, "missing field `value`"),
        (r#"{"tell":[{"id":0,"value":NaN}]}"#, "not valid JSON"),
        (r#"{"tell":[{"id":0,"value":1e999}]}"#, "not valid JSON"),
        (r#"{"tell":[{"id":0,"value":"1"}]}"#, "`tell`"),
        (&header("gp", "minimize", None).to_string(), "already defined"),
    ] {
        talk.error(line, part);
    }
    let tell = json!({"tell": [{"id": 3, "value": 1}, {"id": 0, "value": 2},
                               {"id": 1, "value": 3}, {"id": 2, "value": null}]});
    assert_eq!(talk.answer(&tell), quiet.answer(&tell));
    talk.error(r#"{"tell":[{"id":3,"value":0}]}"#, "id 3 is told twice");
    assert_eq!(talk.ask(4), quiet.ask(4));
}

#[test]
fn a_bad_first_line_is_refused_and_a_good_one_may_follow() {
    let mut talk = Talk::silent();
    talk.error(r#"{"ask":1}"#, "the first line must be");
    let with = |key: &str, value: Value| {
        let mut header = header("cma-es", "minimize", None);
        header[key] = value;
        header.to_string()
    };
    let twice = json!([{"name": "a", "low": 0, "high": 1}, {"name": "a", "low": 0, "high": 1}]);
    for (line, part) in [
        (with("optimizer", json!("cma")), "valid names are gp, cma-es"),
        (with("direction", json!("down")), "minimize"),
        (with("seed", json!(-1)), "-1"),
        (with("batch", json!(0)), "accepted: 1 to 10000"),
        (with("parameters", json!([])), "at least one"),
        (with("parameters", twice), "`a`: is given twice"),
        (with("speed", json!(1)), "unknown field `speed`"),
    ] {
        talk.error(&line, part);
    }
    talk.say(&header("cma-es", "minimize", None).to_string());
    assert_eq!(talk.ask(2).len(), 2);
}

#[test]
fn no_input_is_no_error() {
    assert_eq!(run(&mut command(&["ask-tell"])).succeeds(), "");
}

#[test]
fn what_is_known_can_be_told_and_is_not_asked_again() {
    for name in OptimizerKind::all().map(OptimizerKind::name) {
        let mut header = header(name, "minimize", Some(3));
        header["parameters"][0]["step"] = json!(1);
        let mut talk = Talk::begin(&header);
        let known = |x: i32, n: i32| json!({"values": {"x": x, "n": n}, "value": x * x + n});
        let answer = talk.answer(&json!({"tell": [known(0, 3), known(1, 5)]}));
        let best = json!({"id": null, "values": {"x": 0.0, "n": 3.0}, "value": 3.0});
        assert_eq!(answer["best"], best);
        let at = |values: &str| format!(r#"{{"values":{values},"value":1}}"#);
        for (told, part) in [
            (at(r#"{"x":0,"n":3}"#), "told twice"),
            (at(r#"{"x":0}"#), "`n` is missing"),
            (at(r#"{"x":0.5,"n":1}"#), "`x` is 0.5; accepted: -5 to 5 in steps of 1"),
            (at(r#"{"x":0,"n":1,"m":1}"#), "unknown parameter `m`; accepted: x, n"),
            (r#"{"values":{"x":0,"n":1}}"#.to_owned(), "value"),
            ("[0,1.5]".to_owned(), "must be an object"),
        ] {
            talk.error(&format!("{{\"tell\":[{told}]}}"), part);
        }
        let mut seen = vec![json!({"x": 0.0, "n": 3.0}), json!({"x": 1.0, "n": 5.0})];
        let mut open = None;
        while seen.len() < 55 {
            let points = talk.ask(3);
            for point in &points {
                assert!(!seen.contains(&point["values"]), "{name}: {point}");
                seen.push(point["values"].clone());
            }
            let values = &points[0]["values"];
            let again = json!({"tell": [{"values": values, "value": 1}]});
            talk.error(&again.to_string(), "were asked as id");
            // While a batch is open, too.
            if open.is_none() {
                let free = (1..=9).step_by(2).map(|n| json!({"x": 5.0, "n": f64::from(n)}));
                open = free.into_iter().find(|values| !seen.contains(values));
                let values = open.clone().unwrap();
                talk.answer(&json!({"tell": [{"values": values, "value": 99}]}));
                seen.push(open.clone().unwrap());
            }
            talk.answer(&told(&points, 1.0));
        }
        assert_eq!(talk.ask(1), Vec::<Value>::new(), "{name}: all 55 are known");
    }
}

#[test]
fn sessions_beyond_any_use_are_refused_at_once() {
    let wide = |count: usize, optimizer: &str| {
        let parameter = |i| json!({"name": format!("x{i}"), "low": 0, "high": 1});
        let parameters: Vec<Value> = (0..count).map(parameter).collect();
        json!({"parameters": parameters, "optimizer": optimizer, "seed": 1, "direction": "minimize"})
    };
    let mut talk = Talk::silent();
    talk.error(&wide(20_000, "cma-es").to_string(), "cma-es takes 200 at most");
    talk.error(&wide(50_000, "random").to_string(), "random takes 10000 at most");
    talk.error(&wide(150_000, "random").to_string(), "longer than 4194304 bytes");
    talk.say(&wide(10_000, "random").to_string());
    talk.error(r#"{"ask":1000}"#, "1000000 numbers at once");
    assert_eq!(talk.ask(2).len(), 2);
}
