//! `optimize stiffness`: how far each physical mean carries, and the fingers by their ribs.

use super::stiffness::{decimals, key};
use crate::finger::printed::phases::PHASES;
use crate::finger::printed::stiffness::PlanarStiffness;
use crate::input::stiffness::Axis;
use crate::surrogate::{Comparison, LeftOut, Means, ModelKind, Spread};
use crate::units::{MM, N_PER_MM};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Key, unit in SI, value in SI.
type Quantity = (&'static str, f64, fn(&PlanarStiffness) -> f64);

const QUANTITIES: [Quantity; 5] = [
    ("compliance_n_per_mm", N_PER_MM, PlanarStiffness::in_compliance),
    ("assembly_n_per_mm", N_PER_MM, PlanarStiffness::in_assembly),
    ("tilting_nm_per_rad", 1.0, PlanarStiffness::tilting),
    ("centre_below_pad_mm", MM, PlanarStiffness::centre_below_pad),
    ("centre_from_pad_mm", MM, PlanarStiffness::centre_in_front),
];
/// What the part touches.
const BODIES: [(&str, &str); 2] = [("pad", "pad"), ("pad_and_roof", "pad and roof")];

fn short(model: ModelKind) -> &'static str {
    match model {
        ModelKind::ComputedProcess => "computed",
        ModelKind::ComputedLamina => "both",
        ModelKind::ComputedScale => "scale only",
        _ => "fitted",
    }
}

fn word(left_out: LeftOut) -> String {
    match left_out {
        LeftOut::One => "each".to_owned(),
        LeftOut::Direction(degrees) => format!("{degrees}°"),
        LeftOut::Density(percent) => format!("{percent} %"),
        LeftOut::AllBut(count) => format!("but {count}"),
    }
}

/// Errors of the means, what leave-one-out prefers, and the fingers.
pub fn text(means: &Means) -> String {
    let mut text = String::from(
        "\nMeans compared: the fitted one, the stiffness computed from the ribs, both, and the computed\n\
         one scaled. Mean |error| in % on designs left out: each in turn, all of a direction or density,\n\
         all but 1, 2 or 3 (every choice).\n\n",
    );
    for (i, axis) in Axis::ALL.into_iter().enumerate() {
        let rows: Vec<&Comparison> =
            means.comparisons.iter().filter(|row| row.axis == axis).collect();
        let mut cases: Vec<LeftOut> = Vec::new();
        rows.iter().for_each(|row| {
            if !cases.contains(&row.left_out) {
                cases.push(row.left_out)
            }
        });
        if i == 0 {
            let words: String = cases.iter().map(|&case| format!("{:>7}", word(case))).collect();
            let _ = writeln!(text, "{:<26}{words}", "axis            mean");
        }
        let mut models: Vec<ModelKind> = rows.iter().map(|row| row.model).collect();
        models.dedup();
        for model in models {
            let error = |&case: &LeftOut| {
                let row = rows.iter().find(|row| row.model == model && row.left_out == case);
                format!(
                    "{:>7}",
                    row.map_or("-".into(), |row| decimals(row.mean_absolute_percent, 1))
                )
            };
            let errors: String = cases.iter().map(error).collect();
            let _ = writeln!(text, "{:<16}{:<10}{errors}", axis.label(), short(model));
        }
    }
    text.push('\n');
    for verdict in &means.verdicts {
        let way = if verdict.gain_percent > 0.0 { "less" } else { "more" };
        let clear = if verdict.is_clear() { "" } else { ": within chance (two standard errors)" };
        let _ = writeln!(
            text,
            "{}: each left out, {} misses {:.1} ± {:.1} points {way} than fitted{clear}",
            verdict.axis.label(),
            short(verdict.computed),
            verdict.gain_percent.abs(),
            verdict.standard_error_percent,
        );
    }
    text.push_str("Seven measured fingers or more use the fitted mean, fewer the computed one.\n");
    fingers(&mut text, means);
    text
}

fn fingers(text: &mut String, means: &Means) {
    for (body, (_, touching)) in BODIES.iter().enumerate() {
        let _ = write!(
            text,
            "\nBy the ribs, the part touching {touching}: median of {PHASES} rib phases, lowest .. highest\n\
             {:<14}{:>17}{:>17}{:>17}{:>18}{:>18}\n",
            "design",
            "compliance N/mm",
            "assembly N/mm",
            "tilting Nm/rad",
            "centre below, mm",
            "in front, mm",
        );
        for finger in &means.fingers {
            let m = &finger.measurement;
            let _ = write!(text, "{:>3} %, {:>2}°{:5}", m.density_percent, m.direction_deg, "");
            for (place, (_, unit, quantity)) in QUANTITIES.into_iter().enumerate() {
                let Spread { median, lowest, highest, .. } = finger.spread(body, quantity);
                let places = if place == 0 || place == 2 { 2 } else { 1 };
                let [median, low, high] =
                    [median, lowest, highest].map(|v| decimals(v / unit, places));
                let _ = write!(text, "{median:>6} {:<10}", format!("{low}..{high}"));
            }
            let trimmed = text.trim_end().len();
            text.truncate(trimmed);
            text.push('\n');
        }
    }
    let widest = |quantity: fn(&PlanarStiffness) -> f64| {
        let share = |finger: &crate::surrogate::ComputedFinger| {
            let spread = finger.spread(1, quantity);
            100.0 * spread.by_line_width / spread.median.abs()
        };
        means.fingers.iter().map(share).fold(0.0, f64::max)
    };
    let _ = writeln!(
        text,
        "\nNot in it: lines wider or thinner by print.line_width_mm less ribs.thickness_mm:\n\
         up to {:.0} % of compliance, {:.0} % of tilting stiffness; modulus ± {:.0} % of every stiffness.",
        widest(PlanarStiffness::in_compliance),
        widest(PlanarStiffness::tilting),
        means.modulus_percent,
    );
}

/// Keys `means`, `preferred`, `fingers`, `modulus_sd_percent`.
pub fn json(means: &Means) -> Map<String, Value> {
    let comparisons = means.comparisons.iter().map(|row| {
        let [low, high] = row.range_percent;
        json!({
            "axis": key(row.axis),
            "mean": short(row.model),
            "left_out": word(row.left_out),
            "mean_absolute_percent": row.mean_absolute_percent,
            "lowest_percent": low,
            "highest_percent": high,
        })
    });
    let preferred = means.verdicts.iter().map(|verdict| {
        json!({
            "axis": key(verdict.axis),
            "mean": short(verdict.computed),
            "gain_percent": verdict.gain_percent,
            "standard_error_percent": verdict.standard_error_percent,
            "clear": verdict.is_clear(),
        })
    });
    let fingers = means.fingers.iter().map(|finger| {
        let m = &finger.measurement;
        let body = |body| {
            let quantity = |(key, unit, value): Quantity| {
                let spread = finger.spread(body, value);
                let spread = json!({
                    "median": spread.median / unit,
                    "lowest": spread.lowest / unit,
                    "highest": spread.highest / unit,
                    "by_line_width": spread.by_line_width / unit,
                });
                (key.to_owned(), spread)
            };
            QUANTITIES.into_iter().map(quantity).collect::<Map<String, Value>>()
        };
        json!({
            "design": m.design,
            "infill_density_percent": m.density_percent,
            "infill_direction_deg": m.direction_deg,
            "measured_compliance_n_per_mm": m.compliance / N_PER_MM,
            "measured_assembly_n_per_mm": m.assembly / N_PER_MM,
            "pad": body(0),
            "pad_and_roof": body(1),
        })
    });
    let lists = [
        ("means", comparisons.collect::<Vec<_>>()),
        ("preferred", preferred.collect()),
        ("fingers", fingers.collect()),
    ];
    let lists = lists.into_iter().map(|(key, list)| (key.to_owned(), Value::from(list)));
    lists.chain([("modulus_sd_percent".to_owned(), json!(means.modulus_percent))]).collect()
}
