//! `identify.html`: the identified cell and the curves from which it was identified.

use super::{AXES, FEWER, RANGES, origin, short, unmodelled, validated};
use crate::answer::words::{design, number, outcome, stiffness};
use crate::chart::{Area, DrawResult, HPos, VPos, axes, padded_range, render, text_style};
use crate::elements::{definitions, document, stacked, table};
use crate::marks::{dashed, label, line};
use crate::page::PLOT;
use crate::theme::{BLUE, INK, MUTED, ORANGE, inline};
use calibration::identify::check::Remark;
use calibration::identify::curves::{Curves, STEP_S};
use calibration::identify::formulas::{Flange, Friction};
use calibration::identify::misfit::{Misfit, Validation, misfits};
use calibration::identify::question::{Compared, IdentificationResult, Identified};
use calibration::identify::smoother::Smoothed;
use calibration::identify::unknown::{Unknown, ValueOrigin};
use input::units::MM;
use insertion::Outcome;
use maud::{Markup, PreEscaped, html};
use parameters::{Parameter, Scale};
use plotters::prelude::Color;

/// Largest number of plotted points of a curve, and number of samples before the first contact (0.1 s).
const POINTS: usize = 400;
const AIR: usize = 50;

/// Returns the page: parameters ("numbers") of the cell, robot and probes, and every attempt, measured and simulated.
pub fn html(result: &IdentificationResult) -> String {
    let IdentificationResult { task, runs, remarks, found, .. } = result;
    let (serious, notes): (Vec<_>, Vec<_>) = remarks.iter().partition(|remark| remark.serious);
    let (of_all, of_logs): (Vec<&Remark>, Vec<&Remark>) =
        notes.into_iter().partition(|note| note.file == *runs);
    let unknowns = found.unknowns.iter().map(unknown);
    let body = html! {
        main {
            h1 { (headline(result)) }
            p.lead { (evidence(found)) }
            @for note in of_all { p { b { "All logs: " } (note.text) "." } }
            (definitions(&summary(found)))
            @for remark in serious { p.warn { (remark) } }
            @for sentence in unmodelled(&found.compared) { p.warn { (sentence) } }
            @if !of_logs.is_empty() {
                details { summary { "Notes on single logs" } ul { @for note in of_logs { li { (note) } } } }
            }
            section {
                h2 { "Numbers of the cell" }
                (stacked(&["number", "before", "identified", "remaining deviation", "from"], unknowns))
                p.muted {
                    "× is a factor on the number in the file. Remaining deviation: share of the prior's standard deviation; "
                    "the dashed mark is the share that was expected from these logs."
                }
            }
            section { h2 { "Robot and probes" } (robot(found)) }
            section {
                h2 { "Attempts" }
                p.key {
                    @for (style, of) in [("1px solid var(--muted)", "measured"),
                        ("2px dashed var(--orange)", "simulated with the files' numbers"),
                        ("2px solid var(--blue)", "simulated with the identified ones")] {
                        span { i style={ "border-top:" (style) } {} (of) }
                    }
                }
                p.muted {
                    "Force on the tool in the task's frame, from 0.1 s before the first contact, which begins the search. "
                    "Misfit: root mean square of measured minus simulated force, in standard deviations, with the files' numbers → "
                    "with the identified ones, until a contact is made or lost in only one of the two."
                }
                @if let Some(one) = Validation::of(found) {
                    p.warn[one.is_doubtful()] { (validated(&one)) }
                }
                h3 { "All attempts" }
                (misfit(&found.compared))
                @for one in &found.compared { (attempt(one)) }
            }
        }
    };
    document(&format!("{task}: cell identified from logs"), body)
}

fn counted(found: &Identified, origins: &[ValueOrigin]) -> usize {
    found.unknowns.iter().filter(|one| origins.contains(&one.from)).count()
}

fn headline(IdentificationResult { task, found, .. }: &IdentificationResult) -> String {
    let identified = counted(found, &[ValueOrigin::Formula, ValueOrigin::Fit]);
    let all = identified + counted(found, &[ValueOrigin::Prior]);
    format!("{task}: {identified} of {all} numbers of the cell identified")
}

/// Returns a sentence on how many attempts and probes were used, and how many parameters were not fitted.
fn evidence(found: &Identified) -> String {
    let attempts = input::counted(found.compared.len(), "attempt");
    let probes = input::counted(found.probes.len(), "probe");
    let fixed = match counted(found, &[ValueOrigin::Files]) {
        0 => String::new(),
        count => format!("; {count} more numbers were not fitted"),
    };
    format!("From {attempts} and {probes}{fixed}.")
}

/// Returns, in words, how many attempts have the measured outcome in simulation, and whether there are fewer with the
/// identified parameters than with those of the files.
pub(super) fn outcomes(compared: &[Compared]) -> (String, bool) {
    let [before, after] = [|one: &Compared| one.before.1, |one: &Compared| one.after.1]
        .map(|of| compared.iter().filter(|one| one.logged.outcome == of(one)).count());
    let text = format!(
        "{after} of {} attempts are simulated to end as measured; {before} with the files' numbers",
        compared.len()
    );
    (text, after < before)
}

/// Returns the misfit at the first and the last iteration of the fit, and the share of the data that it compares.
pub(super) fn misfit_of_fit(Smoothed { misfit, compared, .. }: &Smoothed) -> String {
    let share = format!("{:.0} % of the data compared", 100.0 * compared);
    match misfit[..] {
        [first, .., last] if last.is_finite() => {
            format!("{first:.2} to {last:.2} standard deviations over the iterations; {share}")
        }
        _ => share,
    }
}

/// Returns the agreement of the outcomes, and the misfit.
fn summary(found: &Identified) -> Vec<(String, String)> {
    let (outcomes, worse) = outcomes(&found.compared);
    let outcomes = if worse { format!("{outcomes}; {FEWER}") } else { outcomes };
    let rows = [
        ("outcomes", outcomes),
        ("misfit in the fit", misfit_of_fit(&found.smoothed)),
        ("ranges", RANGES.to_owned()),
    ];
    rows.map(|(name, text)| (name.to_owned(), text)).into()
}

/// Returns a row of the table of parameters.
fn unknown(one: &Unknown) -> Vec<Markup> {
    let Unknown { prior, posterior, remaining_sd, from, advice } = one;
    let identified = *from != ValueOrigin::Prior;
    let source = posterior.source.strip_prefix(origin(*from)).unwrap_or(&posterior.source);
    let source = source.trim_start_matches([':', ' ']);
    let (share, expected) = match (remaining_sd, from) {
        // Here `remaining_sd` refers to the formula's value, from which the fit started, not to the prior.
        (_, ValueOrigin::Formula) => (deviation(posterior) / deviation(prior), None),
        (Some([expected, actual]), _) => (*actual, Some(*expected)),
        (None, _) => (1.0, None),
    };
    let percent = |share: f64| format!("{:.0}%", 100.0 * share.clamp(0.0, 1.0));
    vec![
        html! { (posterior.name) },
        html! { (amount(prior)) },
        html! { @if identified { (amount(posterior)) } @else { "as before" } },
        html! {
            // The fit may also widen the prior.
            @if share < 1.0 { (format!("{:.0} %", 100.0 * share)) } @else { "all of it" }
            div.track {
                i.firm style={ "left:0;width:" (percent(share)) } {}
                @if let Some(expected) = expected { b style={ "left:" (percent(expected)) } {} }
            }
        },
        html! {
            (origin(*from)) @if identified && !source.is_empty() { ": " (source) }
            @if let Some(advice) = advice { ": " (advice) }
        },
    ]
}

/// Returns value and standard deviation of a parameter, or its bounds, with the unit.
pub(super) fn amount(row: &Parameter) -> String {
    row.with_unit(&match row.value.zip(row.sd) {
        Some((value, sd)) => format!("{} ± {}", short(value), short(sd)),
        None => format!("{} to {}", short(row.low), short(row.high)),
    })
}

/// Returns the standard deviation of a parameter on its scale, that of its logarithm for a log scale; without a value,
/// that of the uniform distribution between its bounds.
fn deviation(row: &Parameter) -> f64 {
    let log = row.scale == Scale::Log;
    match row.value.zip(row.sd) {
        Some((value, sd)) if log => sd / value,
        Some((_, sd)) => sd,
        None if log => libm::log(row.high / row.low) / 12_f64.sqrt(),
        None => (row.high - row.low) / 12_f64.sqrt(),
    }
}

/// Returns the tables of the robot's axes, preload and probes.
fn robot(found: &Identified) -> Markup {
    let axis = |(name, flange): (&str, &Option<Flange>)| {
        let cells = match flange {
            Some(flange) => vec![
                stiffness(flange.stiffness),
                number(flange.damping, 0, "N s/m"),
                number(flange.mass, 2, "kg"),
                number(1e3 * flange.delay_s, 0, "ms"),
                number(100.0 * flange.explained, 0, "%"),
            ],
            None => vec!["not identifiable from these logs".to_owned()],
        };
        [vec![format!("along {name}")], cells].concat()
    };
    let axes = AXES.into_iter().zip(&found.flange).map(axis);
    let probes = found.probes.iter().map(probe);
    html! {
        (stacked(&["axis", "stiffness", "damping", "mass", "delay of the force", "force explained"], axes))
        @if let Some(preload) = found.preload {
            p { "Preload: " (number(preload.mean / MM, 3, "mm")) ", standard error " (number(preload.sd / MM, 5, "mm")) }
        }
        @if !found.probes.is_empty() {
            (stacked(&["probe", "friction", "tangential over normal force, along y", "and back"], probes))
        }
    }
}

fn probe((file, friction): &(String, Friction)) -> Vec<String> {
    let coefficient = friction.coefficient.map(|one| format!("{:.3} ± {:.3}", one.mean, one.sd));
    let slides = |forth: bool| {
        let words = friction.slides.iter().filter(|slide| slide.forth == forth).map(|slide| {
            format!("{:.3}{}", slide.ratio, if slide.rising { " (the part turned)" } else { "" })
        });
        words.collect::<Vec<_>>().join(", ")
    };
    let coefficient = coefficient.unwrap_or("not identifiable".to_owned());
    vec![file.clone(), coefficient, slides(true), slides(false)]
}

/// Returns a sentence on why a simulated curve is shorter than the measured one, if it is; `name` is its colour.
fn shorter(one: &Compared, simulated: &(Curves, Outcome), name: &str) -> Option<String> {
    let [all, end] = [&one.logged.curves, &simulated.0].map(|curves| curves.force.len());
    let time = end as f64 * STEP_S;
    let why = outcome(simulated.1);
    (end + AIR < all).then(|| {
        format!(" The {name} curve ends at {time:.2} s with the simulated attempt: {why}.")
    })
}

fn attempt(one: &Compared) -> Markup {
    let logged = &one.logged;
    let (ended, off) = (outcome(logged.outcome), logged.outcome != one.after.1);
    html! {
        article {
            h3 { (design(&logged.design)) ", start " (format!("{:+.1} mm", logged.offset / MM)) ": " (ended) }
            p.muted {
                (logged.file) ". Simulated: " (outcome(one.before.1)) " with the files' numbers, "
                (outcome(one.after.1)) " with the identified ones."
                (shorter(one, &one.before, "orange").unwrap_or_default())
                (shorter(one, &one.after, "blue").unwrap_or_default())
            }
            @if off {
                p.warn { "Measured: " (ended) ". The identified cell predicts: " (outcome(one.after.1)) "." }
            }
            div.curves {
                @for (axis, name) in AXES.into_iter().enumerate() {
                    @match render("the curves", PLOT, |area| draw(area, one, axis)) {
                        Ok(svg) => {
                            div role="img" aria-label={ "force along " (name) " over time" } { (PreEscaped(inline(&svg))) }
                        }
                        Err(error) => { p.warn { (error) } }
                    }
                }
            }
            (misfit(std::slice::from_ref(one)))
        }
    }
}

/// Returns the table of the misfits of the force by phase and component, before and after identification.
fn misfit(compared: &[Compared]) -> Markup {
    let number = |misfit: f64| match misfit > 0.0 {
        true => format!("{misfit:.2}"),
        false => "not compared".to_owned(),
    };
    let row = |phase: &[Misfit]| {
        let cells = phase.iter().map(|one| match one.before.max(one.after) > 0.0 {
            true => format!("{} → {}", number(one.before), number(one.after)),
            false => number(0.0),
        });
        phase.first().map(|one| one.phase.to_owned()).into_iter().chain(cells).collect()
    };
    let all = misfits(compared);
    table(&["misfit", "fx", "fy", "fz"], all.chunk_by(|a, b| a.phase == b.phase).map(row))
}

/// Draws one component of the force over time.
fn draw(area: &Area<'_>, one: &Compared, axis: usize) -> DrawResult {
    let Compared { logged, before, after } = one;
    let from = logged.touch.saturating_sub(AIR);
    let points = |curves: &Curves| -> Vec<(f64, f64)> {
        let every = curves.force.len().saturating_sub(from).div_ceil(POINTS).max(1);
        let shown = curves.force.iter().enumerate().skip(from).step_by(every);
        let points = shown.map(|(i, force)| (i as f64 * STEP_S, force[axis]));
        points.filter(|(_, force)| force.is_finite()).collect()
    };
    let [measured, before, after] = [&logged.curves, &before.0, &after.0].map(points);
    let all = || measured.iter().chain(&before).chain(&after);
    let force = padded_range(all().map(|point| point.1), 0.16);
    let (bottom, top) = (force.start, force.end);
    let y_label = format!("force along {} (N)", AXES[axis]);
    let time = padded_range(all().map(|point| point.0), 0.0);
    let aside = 0.012 * (time.end - time.start);
    let mut chart = axes(area, "", ("time (s)", time), (&y_label, force), None)?;
    let phases = [(logged.touch, "search"), (logged.push, "push")];
    for (at, phase) in phases.into_iter().filter(|(at, _)| at + 1 < logged.curves.force.len()) {
        let time = at as f64 * STEP_S;
        dashed(&mut chart, [(time, bottom), (time, top)])?;
        let style = text_style(15, INK, HPos::Left, VPos::Top);
        label(&mut chart, (time + aside, top), (0, 0), phase, &style)?;
    }
    line(&mut chart, measured, MUTED.rgb.stroke_width(1), "")?;
    line(&mut chart, before, ORANGE.rgb.stroke_width(2), "")?;
    line(&mut chart, after, BLUE.rgb.stroke_width(2), "")
}
