//! The analytic checks on the production settings, one test per check so that
//! a failure names it.

use finger_opt::check::{self, Row};
use finger_opt::engine::Engine;
use finger_opt::engine::rapier::{Rapier, Settings};

fn make(factor: f64) -> Box<dyn Engine> {
    let production = Settings::default();
    Box::new(Rapier { settings: Settings { step_s: factor * production.step_s, ..production } })
}

fn assert_passed(rows: Vec<Row>) {
    println!("{}", check::table(&rows));
    assert!(!rows.is_empty());
    assert!(rows.iter().all(|row| row.passed), "\n{}", check::table(&rows));
}

#[test]
fn t1_finger_springs_deflect_as_hooke_says() {
    assert_passed(check::spring::t1(&Rapier::default()));
}

#[test]
fn t2_block_on_an_incline_slides_and_rests_as_coulomb_says() {
    assert_passed(check::incline::t2(&Rapier::default()));
}

#[test]
fn t3_peg_tilts_until_two_points_touch() {
    assert_passed(check::peg::t3(&Rapier::default()));
}

#[test]
fn t4_peg_jams_where_whitney_says() {
    assert_passed(check::jamming::t4(&Rapier::default()));
}

#[test]
fn t5_peg_wedges_where_whitney_says() {
    assert_passed(check::wedging::t5(&Rapier::default()));
}

#[test]
fn t6_chamfer_takes_the_force_of_its_angle_and_friction() {
    assert_passed(check::chamfer::t6(&Rapier::default()));
}

#[test]
fn t7_force_through_the_remote_centre_does_not_turn() {
    assert_passed(check::spring::t7(&Rapier::default()));
}

#[test]
fn t8_block_tips_at_the_edge() {
    assert_passed(check::edge::t8(&Rapier::default()));
}

#[test]
fn t8_step_and_snapshots_change_nothing() {
    assert_passed(check::step::t8(&make));
}

#[test]
fn t10_light_wedged_plug_does_not_sink() {
    assert_passed(check::peg::t10(&Rapier::default()));
}
