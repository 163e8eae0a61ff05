//! The forms P1 to P11 of an engine with the settings of the trials. Where a form is missed since contacts
//! yield, it is repeated with stiffer ones: a deviation that halves with the compliance passes.

use super::{Rounding, engine, rounded, sharp, turned};
use crate::CheckRow;

/// Factors of the stiffness of contacts.
const FACTORS: [f64; 3] = [1.0, 2.0, 4.0];
/// Share of a deviation that remains at half the compliance: a half, and a margin for a line of contact,
/// whose stiffness counts the 2 or 4 points that it happens to have.
const HALVED: f64 = 0.7;

/// Returns the rows of an engine by its name; none for an unknown one.
pub fn forms(name: &str) -> Vec<CheckRow> {
    let at = |factor| {
        let engine = engine(name, factor)?;
        let rows = [sharp(&*engine), rounded(&*engine, Rounding::Core), turned(&*engine)];
        Some(rows.concat())
    };
    let Some(mut usual) = at(FACTORS[0]) else { return Vec::new() };
    // At rest, and where the forces are but a sign, stiffness counts for nothing.
    let follows = |row: &CheckRow| !row.passed && ["P3", "P4", "P5"].contains(&row.check);
    if !usual.iter().any(follows) {
        return usual;
    }
    let stiffer = [FACTORS[1], FACTORS[2]].map(|factor| at(factor).unwrap_or_default());
    for i in (0..usual.len()).rev().filter(|&i| follows(&usual[i])).collect::<Vec<_>>() {
        let mut rows = vec![usual[i].clone()];
        for (factor, stiffer) in FACTORS[1..].iter().zip(&stiffer) {
            let Some(row) = stiffer.get(i) else { continue };
            let quantity = format!("... with contacts {factor} times as stiff");
            rows.push(CheckRow { quantity, ..row.clone() });
        }
        let halves = rows
            .windows(2)
            .all(|two| two[1].passed || two[1].error().abs() <= HALVED * two[0].error().abs());
        for row in &mut rows {
            row.passed = halves && !row.measured.is_nan();
        }
        usual.splice(i..=i, rows);
    }
    usual
}
