//! Every figure is drawn, for all tasks and for one.

use super::*;
use crate::evaluation::tolerance::{Search, evaluate};
use crate::input::finger::FingerModel;
use crate::input::published;
use crate::input::stiffness::Measurement;
use crate::trial::fake::FakeRig;
use crate::verify::compare::Subject;

fn tables(tasks: &[&str]) -> Vec<TaskTable> {
    let designs = published::designs();
    let window = |m: &Measurement| {
        let subject = Subject::new("usb", &FingerModel::default(), *m);
        evaluate(&FakeRig::default(), &subject.finger, Search::Strides).window
    };
    let table = |task: &&str| TaskTable::new(task, designs.iter().map(|m| (*m, window(m))));
    tasks.iter().map(table).collect()
}

#[test]
fn figures_are_drawn_for_all_tasks_and_for_one() {
    for tasks in [&["ket8", "ket12", "rj45", "usb"][..], &["usb"]] {
        let figures = figures(&tables(tasks)).unwrap();
        assert_eq!(figures.len(), 3 + tasks.len());
        for (name, svg) in figures {
            assert!(name.ends_with(".svg"));
            assert!(svg.contains("</svg>") && !svg.contains("NaN"), "{name}");
        }
    }
}

#[test]
fn the_heat_map_shows_the_published_score() {
    let svg = &figures(&tables(&["usb"])).unwrap()[2].1;
    assert!(svg.contains("score 27.3 % (6 of 22 ends)"));
}
